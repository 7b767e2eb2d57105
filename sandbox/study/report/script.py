"""R script with the same models, which reads the CSV files of the report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sandbox.study.report.models.analysis import Analysis, MeasureModel
from sandbox.study.report.models.censored import bounded_rows
from sandbox.study.report.models.data import StudyData
from sandbox.study.report.models.mixed import PRACTICE, Mixed, fixed_effects
from sandbox.study.report.models.quantities import LOG

if TYPE_CHECKING:
    from pandas import DataFrame

HEAD = """\
# The models of report.html, in R: Rscript analysis.R, in the folder of the CSVs.
# Needs lme4, and uses survival and geepack if they are installed. Writes comparisons_R.csv.

options(width = 100)
# Names of levels may have letters that the locale lacks, as that of many scheduled jobs.
for (locale in c("C.UTF-8", "en_US.UTF-8"))
  if (!l10n_info()[["UTF-8"]]) suppressWarnings(Sys.setlocale("LC_CTYPE", locale))
text <- read.csv("trials.csv", colClasses = "character", check.names = FALSE,
                 na.strings = character(0), encoding = "UTF-8")
trials <- text
# Pseudonyms such as 12E345 and levels such as 1 are not numbers.
for (name in setdiff(names(text), {texts}))
  trials[[name]] <- suppressWarnings(as.numeric(text[[name]]))
columns <- c("factor", "first", "second", "condition")
contrasts <- read.csv("contrasts.csv", colClasses = sapply(columns, function(name) "character"),
                      encoding = "UTF-8")
conditions <- {conditions}
trials$condition <- factor(trials$condition, levels = conditions)
within <- {within}
found <- NULL

# Differences between levels from the means of conditions: t intervals whose degrees of freedom are
# those of a paired t test over the people who did both, or of groups.
compare <- function(measure, model, rows, estimate, covariance) {{
  names(estimate) <- sub("^condition", "", names(estimate))
  dimnames(covariance) <- list(names(estimate), names(estimate))
  for (pair in split(contrasts, ~ factor + first + second, drop = TRUE)) {{
    if (!all(pair$condition %in% names(estimate))) next
    w <- setNames(rep(0, length(estimate)), names(estimate))
    w[pair$condition] <- pair$weight
    people <- length(unique(rows$ppid))
    # Who did one condition only says nothing of how differences vary.
    who <- function(side) unique(rows$ppid[rows$condition %in% pair$condition[side]])
    one <- who(pair$weight < 0)
    other <- who(pair$weight > 0)
    both <- length(intersect(one, other))
    paired <- if (both > 0) both - 1 else length(union(one, other)) - 2
    groups <- length(unique(rows[[paste0("factor_", pair$factor[1])]]))
    freedom <- if (pair$factor[1] %in% within) paired else people - groups
    value <- sum(w * estimate)
    error <- sqrt(drop(t(w) %*% covariance %*% w))
    half <- qt(0.975, freedom) * error
    found <<- rbind(found, data.frame(
      measure = measure, model = model, factor = pair$factor[1], first = pair$first[1],
      second = pair$second[1], estimate = value, low = value - half, high = value + half,
      error = error, freedom = freedom, p = 2 * pt(-abs(value / error), freedom)))
  }}
}}
"""

MIXED = """
# {title}: linear mixed model{scale}.
rows <- trials[is.finite(trials${name}){more}, ]
{thin}rows$y <- {forward}
rows$condition <- droplevels(rows$condition)
rows$practice <- log2(rows$position) - mean(log2(rows$position))
fit <- lme4::lmer({formula}, data = rows, REML = TRUE)
print(summary(fit), correlation = FALSE)
compare("{name}", "mixed model", rows, lme4::fixef(fit), as.matrix(vcov(fit)))
"""

CENSORED = """
# Completion time where some were not seen: a trial without success took longer than it lasted.
if (requireNamespace("survival", quietly = TRUE)) {{
  rows <- trials[trials$time_s > 0, ]
  rows <- rows[rows$condition %in% rows$condition[rows$success == 1], ]
  rows$condition <- droplevels(rows$condition)
  rows$practice <- log2(rows$position) - mean(log2(rows$position))
  tobit <- function(rows) {{
    fit <- survival::survreg(survival::Surv(time_s, success) ~ {fixed}, data = rows,
                             dist = "lognormal")
    coef(fit)
  }}
  all <- tobit(rows)
  # The jackknife that leaves one person out.
  people <- unique(rows$ppid)
  without <- sapply(people, function(who) tobit(rows[rows$ppid != who, ])[names(all)])
  centred <- without - rowMeans(without)
  covariance <- (length(people) - 1) / length(people) * centred %*% t(centred)
  compare("time_s", "with unseen times", rows, all, covariance)
}}
"""

SUCCESS = """
# Success: differences of people's own shares, and odds by generalised estimating equations.
own <- tapply(trials$success, list(trials$ppid, trials$condition), mean)
print(round(colMeans(own, na.rm = TRUE), 4))
if (requireNamespace("geepack", quietly = TRUE) && {finite}) {{
  rows <- trials[order(trials$ppid), ]
  rows$condition <- droplevels(rows$condition)
  rows$practice <- log2(rows$position) - mean(log2(rows$position))
  # Plain sandwich errors: smaller than those of Mancl and DeRouen, which the report has.
  fit <- geepack::geeglm(success ~ {fixed}, data = rows, id = factor(ppid),
                         family = binomial, corstr = "exchangeable")
  compare("success", "GEE", rows, coef(fit), vcov(fit))
}}
"""

TAIL = """
# Estimates are on the scale of the model: of logarithms of times, of log odds.
print(found, digits = 5, row.names = FALSE)
write.csv(found, "comparisons_R.csv", row.names = FALSE)
"""


def script(analysis: Analysis) -> str:
    """Creates the R script."""
    data = analysis.data
    texts = ["ppid", "condition", "status", *(f.column for f in data.factors)]
    parts = [
        HEAD.format(
            texts=_vector(texts),
            conditions=_vector(list(data.conditions)),
            within=_vector([f.name for f in data.factors if f.within]),
        )
    ]
    for one in (analysis.time, *analysis.asked):
        if one is not None and isinstance(one.model, Mixed):
            parts.append(_mixed(one, one.model))
    if len(data.conditions) > 1:
        if analysis.unseen:
            parts.append(CENSORED.format(fixed=_fixed(data, bounded_rows(data))))
        finite = "FALSE" if isinstance(analysis.odds, str) else "TRUE"
        parts.append(SUCCESS.format(fixed=_fixed(data, data.used), finite=finite))
    return "".join(parts) + TAIL


def _fixed(data: StudyData, rows: DataFrame) -> str:
    """Right side of a formula: conditions, and practice where these rows can tell it from them."""
    both = PRACTICE in fixed_effects(rows, data.conditions)[1]
    return "0 + condition" + (" + practice" if both else "")


def _mixed(one: MeasureModel, model: Mixed) -> str:
    what = one.described.what
    several = "condition" if len(model.present) > 1 else "1"
    terms = ["0 + condition" if several == "condition" else "1"]
    if PRACTICE in model.names:
        terms.append("practice")
    terms.append("(1 | ppid)")
    terms += [
        f"(1 | ppid:`factor_{k.removeprefix('person x ')}`)"
        for k in model.spreads
        if k.startswith("person x ")
    ]
    more = ""
    if what.scale == LOG:
        more = f" & trials${what.name} > 0"
    if what.name == "time_s":
        more += " & trials$success == 1"
    # A measure over several trials is repeated in all of their rows.
    thin = (
        ""
        if model.trials == sum(s.trials for s in one.described.conditions)
        else ("rows <- rows[!duplicated(rows[c('ppid', 'condition')]), ]\n")
    )
    return MIXED.format(
        title=what.title,
        scale=" of the logarithm" if what.scale == LOG else "",
        name=what.name,
        more=more,
        thin=thin,
        forward=f"log(rows${what.name})" if what.scale == LOG else f"rows${what.name}",
        formula="y ~ " + " + ".join(terms),
    )


def _vector(names: list[str]) -> str:
    return "c(" + ", ".join(map(_quoted, names)) + ")" if names else "character(0)"


def _quoted(text: str) -> str:
    """A string of R, all of ASCII: R reads a script in the encoding of its locale."""
    plain = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isascii() else f"\\U{ord(c):08x}" for c in plain) + '"'
