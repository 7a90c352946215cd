# Rank tests of means over 3, 6 and 7 whole answers, most with unequal numbers of visits, on integer sums over a
# common denominator, where ties are ties. (R on the means themselves breaks them.) Prints means_by_rank.json:
#   Rscript means_by_rank.R > means_by_rank.json
set.seed(15)
gcd <- function(a, b) if (b == 0) a else gcd(b, a %% b)
lcm <- function(v) Reduce(function(a, b) a / gcd(a, b) * b, unique(v))
num <- function(x) sprintf("%.17g", x)
list_of <- function(x) paste0("[", paste(x, collapse = ", "), "]")

# P(V <= v), P(V >= v) given the midranks of |d|, by convolution of doubled ranks.
exact_p <- function(d) {
  d <- d[d != 0]
  twice <- 2 * rank(abs(d))
  at <- sum(twice[d > 0])
  weights <- 1
  for (step in twice) weights <- (c(weights, rep(0, step)) + c(rep(0, step), weights)) / 2
  sums <- seq_along(weights) - 1
  min(1, 2 * min(sum(weights[sums <= at]), sum(weights[sums >= at])))
}
hodges_lehmann <- function(d) { walsh <- outer(d, d, "+") / 2; median(walsh[lower.tri(walsh, diag = TRUE)]) }

paired <- function(x, y, denominator) {
  d <- x - y
  test <- suppressWarnings(wilcox.test(x, y, paired = TRUE, exact = FALSE, correct = TRUE))
  sprintf('{"n_used": %d, "n_zero": %d, "v": %s, "p_normal": %s, "p_exact": %s, "location": %s}',
          sum(d != 0), sum(d == 0), num(test$statistic), num(test$p.value), num(exact_p(d)),
          num(hodges_lehmann(d) / denominator))
}

study <- function(items, people, visits) {
  rows <- NULL
  for (person in 1:people) for (method in 1:3) for (visit in seq_len(sample(visits, 1)))
    rows <- rbind(rows, c(person - 1, visit - 1, method - 1, sum(sample(0:3, items, TRUE, c(5, 3 + method / 2, 1, 1)))))
  cell <- function(value) tapply(value, list(rows[, 1], rows[, 3]), sum)
  sums <- cell(rows[, 4]); counts <- items * cell(rep(1, nrow(rows)))
  denominator <- lcm(as.vector(counts))
  whole <- sums * (denominator / counts)
  all <- friedman.test(whole)
  pairs <- c(paired(whole[, 1], whole[, 2], denominator), paired(whole[, 1], whole[, 3], denominator),
             paired(whole[, 2], whole[, 3], denominator))
  sprintf('{"items": %d, "people": %d,\n "reports": %s,\n "pairs": %s,\n "friedman": {"chi2": %s, "p": %s}}', items, people,
          list_of(apply(rows, 1, list_of)), list_of(pairs), num(all$statistic), num(all$p.value))
}

studies <- study(3, 20, c(1, 1))
for (items in c(3, 6, 7)) for (people in c(12, 26)) studies <- c(studies, study(items, people, 1:4))
cat(sprintf('{"r": "%s", "script": "means_by_rank.R", "studies": [\n%s]}\n', R.version.string, paste(studies, collapse = ",\n")))
