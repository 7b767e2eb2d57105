# What R computes of the studies of `reference.py`, which runs this script:
#   Rscript reference.R numbers.csv found.csv
# Needs survival and coin.

files <- commandArgs(trailingOnly = TRUE)
numbers <- read.csv(files[[1]])

# P value of the mean of d among all flips of the signs of d.
flips <- function(d) {
  signs <- as.matrix(expand.grid(rep(list(c(-1, 1)), length(d))))
  mean(abs(signs %*% d) >= abs(sum(d)) - 1e-9)
}

# P value of Wilcoxon's signed ranks, of ties by all flips of signs; differences of 0 are left out.
ranks <- function(first, second) {
  d <- second - first
  d <- d[d != 0]
  if (!anyDuplicated(abs(d))) return(wilcox.test(d, exact = TRUE)$p.value)
  coin::pvalue(coin::wilcoxsign_test(second ~ first, distribution = "exact",
                                     zero.method = "Wilcoxon"))
}

one <- function(study) {
  first <- study$value[study$side == "first"]
  second <- study$value[study$side == "second"]
  kind <- study$kind[[1]]
  rmean <- flipped <- NA
  if (kind == "groups") {
    t <- t.test(second, first)
    estimate <- mean(second) - mean(first)
    ranked <- suppressWarnings(wilcox.test(second, first)$p.value)
  } else {
    t <- t.test(second, first, paired = TRUE)
    estimate <- t$estimate[[1]]
    ranked <- ranks(first, second)
    if (length(first) <= 13) flipped <- flips(second - first)
  }
  if (kind == "times") {
    # Who has not succeeded has the limit as the time.
    curve <- survival::survfit(survival::Surv(second, second < 20) ~ 1)
    rmean <- summary(curve, rmean = 20)$table[["rmean"]]
  }
  data.frame(study = study$study[[1]], estimate = estimate, low = t$conf.int[[1]],
             high = t$conf.int[[2]], t = t$p.value, ranks = ranked, flips = flipped,
             rmean = rmean)
}

found <- do.call(rbind, lapply(split(numbers, numbers$study), one))
# Every ten studies are one family.
found$holm <- ave(found$t, found$study %/% 10, FUN = function(p) p.adjust(p, "holm"))
found[-1] <- lapply(found[-1], function(x) ifelse(is.na(x), "", sprintf("%.12g", x)))
write.csv(found, files[[2]], row.names = FALSE, quote = FALSE)
