# Fits models in R to a study's tables, for the pairs of levels that the report compares:
#   Rscript analysis.R [TABLES]
# The script reads the tables in the folder TABLES (default: ../tables, those of the study) and
# results.csv in the folder of this script. It writes results_R.csv, whose results the next report
# shows beside its own numbers, on the same scale. Needs lme4, survival, emmeans and ordinal.

options(width = 100)
# Names of levels may have letters that the locale does not support, so a UTF-8 locale is set.
for (locale in c("C.UTF-8", "en_US.UTF-8"))
  if (!l10n_info()[["UTF-8"]]) suppressWarnings(Sys.setlocale("LC_CTYPE", locale))
given <- commandArgs(trailingOnly = TRUE)
folder <- if (length(given)) given[[1]] else "../tables"
# Tables name these columns as the program does, or as UXF does. The names of UXF are used here.
uxf <- c(participant = "ppid", session = "session_num", trial = "trial_num")
words <- function(file) {
  table <- read.csv(file, colClasses = "character", check.names = FALSE,
                    na.strings = character(0), encoding = "UTF-8")
  ours <- names(table) %in% names(uxf)
  names(table)[ours] <- uxf[names(table)[ours]]
  table
}
number <- function(text) suppressWarnings(as.numeric(text))

# First the trials that count, without practice, in order: practice_ is the logarithm of a trial's
# number in them. Then excluded trials and trials without a result are left out.
trials <- words(file.path(folder, "trials.csv"))
trials <- trials[trials$counted == "1" & trials$practice != "1", ]
trials <- trials[order(number(trials$session_num), number(trials$trial_num)), ]
trials$practice_ <- log2(ave(seq_along(trials$ppid), trials$ppid, FUN = seq_along))
trials <- trials[trials$excluded != "1" & trials$success %in% c("0", "1"), ]
solved <- trials$success == "1"
limits <- number(trials[["limit_s"]])
if (!length(limits) || all(is.na(limits))) limits <- rep(max(number(trials$time_s)), nrow(trials))
scores <- file.path(folder, "scores.csv")
scores <- if (file.exists(scores)) words(scores) else NULL
pairs <- words("results.csv")
pairs <- pairs[pairs$row == "pair" & pairs$estimate != "", ]

# Data for the model of an outcome. `rows` has the person, the value y, practice, and the factors
# f1_, f2_, ..., whose levels are L1, L2, ... `names` has the names of the factors and levels.
rows_of <- function(outcome, scale) {
  if (scale == "score") {
    table <- scores[scores$instrument == outcome, ]
    table <- table[table$scale == table$scale[[1]] & table$score != "", ]
    rows <- data.frame(ppid = table$ppid, y = number(table$score), practice_ = 0)
  } else {
    table <- trials
    rows <- data.frame(ppid = table$ppid, y = number(table[[outcome]]),
                       practice_ = table$practice_)
    if (scale == "limit") rows$y <- ifelse(solved, pmin(rows$y, limits), limits)
    if (scale == "log") rows$y <- log(ifelse(rows$y > 0, rows$y, NA))
  }
  names <- list()
  for (column in grep("^factor_.", names(table), value = TRUE)) {
    levels <- unique(table[[column]][table[[column]] != ""])
    if (length(levels) < 2) next
    own <- sprintf("f%d_", length(names) + 1)
    names[[sub("^factor_", "", column)]] <- list(own = own, levels = levels)
    rows[[own]] <- factor(match(table[[column]], levels), labels = paste0("L", seq_along(levels)))
  }
  list(rows = rows[is.finite(rows$y), ], names = names)
}

terms_of <- function(data) {
  practice <- if (any(data$rows$practice_ != 0)) "practice_"
  paste(c(sapply(data$names, `[[`, "own"), practice), collapse = " + ")
}

# Random intercepts for people, and for each person and level if people did a level several times.
chance_of <- function(data) {
  several <- Filter(function(own) {
    met <- paste(data$rows$ppid, data$rows[[own]])
    anyDuplicated(met) && length(unique(met)) > length(unique(data$rows$ppid))
  }, sapply(data$names, `[[`, "own"))
  paste(c("(1 | ppid)", sprintf("(1 | ppid:%s)", several)), collapse = " + ")
}

# A model with all factors and practice as fixed effects, and random effects of people.
fit <- function(data, scale) {
  right <- paste(terms_of(data), chance_of(data), sep = " + ")
  with_y <- function(y) as.formula(paste(y, "~", right))
  if (scale == "share") return(lme4::glmer(with_y("y"), data = data$rows, family = binomial))
  if (scale == "count") return(lme4::glmer(with_y("y"), data = data$rows, family = poisson))
  if (scale == "score") {
    data$rows$class_ <- factor(data$rows$y, ordered = TRUE)
    return(ordinal::clmm(with_y("class_"), data = data$rows, Hess = TRUE))
  }
  lme4::lmer(with_y("y"), data = data$rows)
}

# Means by the levels of one factor, on the scale of the outcome.
means_of <- function(model, data, own) {
  if (inherits(model, "clmm")) {
    # The expected score: the mean of the classes, weighted by their probabilities.
    classes <- emmeans::emmeans(model, as.formula(paste("~ class_ |", own)), mode = "prob")
    weights <- list(score = sort(unique(data$rows$y)))
    return(emmeans::contrast(classes, weights))
  }
  grid <- emmeans::emmeans(model, own, data = data$rows)
  if (inherits(model, "glmerMod")) emmeans::regrid(grid) else grid
}

found <- NULL
add <- function(pair, model, kind, estimate, low, high, p) {
  found <<- rbind(found, data.frame(
    outcome = pair$outcome, factor = pair$factor, first = pair$first, second = pair$second,
    model = model, kind = kind, estimate = estimate, low = low, high = high, p = p))
}

# Compares the second level of a pair with the first, by the means of a model.
compare <- function(pair, model, data) {
  factor <- data$names[[pair$factor]]
  weights <- (factor$levels == pair$second) - (factor$levels == pair$first)
  means <- means_of(model, data, factor$own)
  difference <- emmeans::contrast(means, list(weights), by = NULL)
  one <- as.data.frame(summary(difference, infer = TRUE, adjust = "none"))
  ends <- unlist(one[1, c("estimate", grep("CL$", names(one), value = TRUE))])
  if (pair$scale == "log") ends <- exp(ends)
  add(pair, class(model)[[1]], pair$kind, ends[[1]], ends[[2]], ends[[3]], one$p.value[[1]])
}

# The ratio of times to success. Trials without success are censored at the time limit.
survival_ratio <- function(pair, data) {
  rows <- data$rows
  rows$solved_ <- solved[as.numeric(rownames(rows))]
  factor <- data$names[[pair$factor]]
  rows[[factor$own]] <- relevel(rows[[factor$own]], paste0("L", match(pair$first, factor$levels)))
  cluster <- survival::cluster
  formula <- as.formula(paste("survival::Surv(y, solved_) ~", terms_of(data), "+ cluster(ppid)"))
  model <- survival::survreg(formula, data = rows[rows$y > 0, ], dist = "lognormal")
  term <- paste0(factor$own, "L", match(pair$second, factor$levels))
  value <- coef(model)[[term]]
  error <- sqrt(diag(vcov(model)))[[term]]
  ends <- exp(value + c(0, -1, 1) * qnorm(0.975) * error)
  add(pair, "survreg, lognormal", "ratio", ends[[1]], ends[[2]], ends[[3]],
      2 * pnorm(-abs(value / error)))
}

told <- function(what, work) tryCatch(suppressMessages(work), error = function(e) {
  message(what, ": ", conditionMessage(e))
  NULL
})
rownames(trials) <- NULL
for (outcome in unique(pairs$outcome)) {
  own <- pairs[pairs$outcome == outcome, ]
  data <- rows_of(outcome, own$scale[[1]])
  model <- told(outcome, fit(data, own$scale[[1]]))
  for (i in seq_len(nrow(own))) {
    pair <- as.list(own[i, ])
    what <- paste0(outcome, ", ", pair$second, " against ", pair$first)
    if (!is.null(model)) told(what, compare(pair, model, data))
    if (pair$scale == "limit") told(what, survival_ratio(pair, data))
  }
}

columns <- grep("^factor_.", names(trials), value = TRUE)
condition <- do.call(paste, c(trials[columns], sep = " / "))
if (any(tapply(solved, condition, mean) %in% c(0, 1)))
  message("success: all or no trials of some combinations succeeded, so that a model of success ",
          "has no finite estimate for them")

# Prints the restricted mean time of each combination of levels, by survival::survfit.
if (all(is.finite(limits)) && nrow(trials) > 0) {
  time <- pmin(ifelse(solved, number(trials$time_s), limits), limits)
  # The mean of each combination is restricted to its own limit.
  means <- sapply(unique(condition), function(one) {
    own <- condition == one
    curve <- survival::survfit(survival::Surv(time[own], solved[own]) ~ 1)
    summary(curve, rmean = max(limits[own]))$table
  })
  print(t(means), digits = 6)
}

if (!is.null(found)) {
  print(found, digits = 5, row.names = FALSE)
  write.csv(found, "results_R.csv", row.names = FALSE)
}
