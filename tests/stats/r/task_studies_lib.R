# Functions of task_studies.R: JSON, scores and tests by R's own functions, in the structure of vip-stats'
# results.

methods <- c("LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes")
n_stars <- c("16k", "32k")
scenes <- c("single_dam", "jet_impact", "faucet")
items <- c("disorientation", "unrealism", "dizziness", "confusion")
alpha <- 0.05
margins <- c(realism = 0.5, sickness = 0.25, sickness_without_unrealism = 0.25)

# Named lists are objects, lists and longer vectors arrays, NA and NULL null.
json <- function(x) {
  if (is.null(x)) return("null")
  if (is.list(x)) {
    parts <- vapply(x, json, "")
    if (!is.null(names(x))) return(paste0("{", paste0('"', names(x), '": ', parts, collapse = ", "), "}"))
    return(paste0("[", paste(parts, collapse = ", "), "]"))
  }
  if (length(x) != 1) return(json(as.list(x)))
  if (is.na(x)) return("null")
  if (is.logical(x)) return(if (x) "true" else "false")
  if (is.character(x)) return(paste0('"', x, '"'))
  if (is.infinite(x)) return(if (x > 0) '"Inf"' else '"-Inf"')
  sprintf("%.17g", x)
}

gcd <- function(a, b) if (b == 0) a else gcd(b, a %% b)
lcm <- function(v) Reduce(function(a, b) a / gcd(a, b) * b, unique(v), 1)
stars <- function(p) if (is.na(p)) "" else if (p < 0.001) "***" else if (p < 0.01) "**" else if (p < 0.05) "*" else ""
# Missing tests count as p = 1, so that the family keeps its size. Their own corrected p is missing.
corrected <- function(p, how) { out <- p.adjust(ifelse(is.na(p), 1, p), how); out[is.na(p)] <- NA; out }
constant <- function(x) length(x) > 1 && all(x == x[1])
attempt <- function(value) tryCatch(suppressWarnings(value), error = function(e) NULL)

shapiro <- function(x) {
  test <- attempt(shapiro.test(x))
  if (is.null(test)) NULL else list(w = unname(test$statistic), p = test$p.value)
}

# The noncentrality parameters at which t is the upper and the lower 2.5 % point, times `scale`.
effect_ci <- function(t, df, scale) {
  at <- function(p) uniroot(function(ncp) pt(t, df, ncp) - p, c(-37, 37), tol = 1e-13)$root
  c(at(1 - alpha / 2), at(alpha / 2)) * scale
}
hedges <- function(df) exp(lgamma(df / 2) - lgamma((df - 1) / 2)) / sqrt(df / 2)

# P(V <= v) and P(V >= v) given the midranks of |d|, by convolution of doubled ranks.
signed_tails <- function(d) {
  twice <- 2 * rank(abs(d))
  at <- sum(twice[d > 0])
  weights <- 1
  for (step in twice) weights <- (c(weights, rep(0, step)) + c(rep(0, step), weights)) / 2
  sums <- seq_along(weights) - 1
  c(sum(weights[sums <= at]), sum(weights[sums >= at]))
}

# Signed-rank test, estimate and interval of differences that are whole numbers over one denominator.
signed_ranks <- function(whole, denominator) {
  used <- whole[whole != 0]
  if (length(used) == 0) return(NULL)
  test <- suppressWarnings(wilcox.test(whole, exact = FALSE, correct = TRUE))
  walsh <- outer(whole, whole, "+") / 2
  walsh <- sort(walsh[lower.tri(walsh, diag = TRUE)])
  ranks <- rank(abs(used))
  n <- length(whole)
  cut <- max(qsignrank(alpha / 2, n), 1)
  ci <- c(walsh[cut], walsh[length(walsh) + 1 - cut]) / denominator
  level <- 1 - 2 * psignrank(cut - 1, n)
  exact <- min(1, 2 * min(signed_tails(used)))
  list(w = unname(test$statistic), p = exact, p_exact = exact, p_normal = test$p.value,
       location = median(walsh) / denominator, ci = ci, ci_level = level,
       rank_biserial = (sum(ranks[used > 0]) - sum(ranks[used < 0])) / sum(ranks), n_used = length(used),
       n_zero = n - length(used))
}

one_cell <- function(values) {
  n <- length(values)
  if (n == 0) return(list(n = 0, mean = NA, sd = NA, ci = NA, values = list()))
  quartiles <- unname(quantile(values, c(0.5, 0.25, 0.75)))
  reach <- 1.5 * (quartiles[3] - quartiles[2]) + 1e-12  # a value on the fence is within, but for rounding
  inside <- values[values >= quartiles[2] - reach & values <= quartiles[3] + reach]
  test <- attempt(t.test(values))
  out <- list(n = n, mean = mean(values), sd = if (n > 1) sd(values) else NA,
              ci = if (is.null(test) || constant(values)) NA else as.vector(test$conf.int),
              median = quartiles[1], q1 = quartiles[2], q3 = quartiles[3],
              # Unlike boxplot.stats, a whisker does not end inside the box.
              whisker_low = min(inside, quartiles[2]), whisker_high = max(inside, quartiles[3]), outliers = as.list(values[values < min(inside) | values > max(inside)]),
              values = as.list(values))
  normality <- shapiro(values)
  if (!is.null(normality)) out$normality <- normality
  out
}

# Sums and counts of two methods, person by person.
compare <- function(a, b) {
  both <- !is.na(a$sum) & !is.na(b$sum)
  x <- (a$sum / a$count)[both]; y <- (b$sum / b$count)[both]
  denominator <- if (any(both)) lcm(c(a$count[both], b$count[both])) else 1
  whole <- a$sum[both] * (denominator / a$count[both]) - b$sum[both] * (denominator / b$count[both])
  list(x = x, y = y, whole = whole, denominator = denominator, d = whole / denominator, n = sum(both),
       n_missing = sum(is.na(a$sum) != is.na(b$sum)), same = constant(whole))
}

sign_p <- function(pair, null, side) {
  d <- pair$d[1]
  if (d == null) return(1)
  tail <- 2^-pair$n
  if (side == "two.sided") min(1, 2 * tail) else if ((d > null) == (side == "greater")) tail else 1
}

comparison <- function(pair, margin) {
  out <- list(n = pair$n, n_missing = pair$n_missing, mean_a = if (pair$n) mean(pair$x) else NA,
              mean_b = if (pair$n) mean(pair$y) else NA)
  test <- if (pair$same) NULL else attempt(t.test(pair$x, pair$y, paired = TRUE))
  if (!is.null(test)) {
    df <- unname(test$parameter); t <- unname(test$statistic); n <- pair$n
    two <- t.test(pair$x, pair$y, paired = TRUE, conf.level = 1 - 2 * alpha)
    lower <- t.test(pair$x, pair$y, paired = TRUE, mu = -margin, alternative = "greater")$p.value
    upper <- t.test(pair$x, pair$y, paired = TRUE, mu = margin, alternative = "less")$p.value
    d_ci <- effect_ci(t, df, 1 / sqrt(n))
    out <- c(out, list(test = "paired t test", difference = unname(test$estimate), ci = as.vector(test$conf.int), t = t,
                       df = df, p = test$p.value, stars = stars(test$p.value), sd_difference = sd(pair$x - pair$y),
                       d_z = t / sqrt(n), d_z_ci = d_ci, g = if (df > 1) hedges(df) * t / sqrt(n) else NA,
                       g_ci = if (df > 1) hedges(df) * d_ci else NA,
                       tost = list(margin = margin, p = max(lower, upper), ci = as.vector(two$conf.int),
                                   ci_confidence = 1 - 2 * alpha, equivalent = max(lower, upper) < alpha)))
  } else {
    p <- if (pair$same) sign_p(pair, 0, "two.sided") else NA
    out <- c(out, list(test = if (pair$same) "exact sign test" else NA, difference = if (pair$same) pair$d[1] else NA,
                       ci = NA, t = NA, df = NA, p = p, stars = stars(p), sd_difference = NA, d_z = NA, d_z_ci = NA,
                       g = NA, g_ci = NA))
  }
  welch <- attempt(t.test(pair$x, pair$y))
  if (!is.null(welch) && !is.nan(welch$statistic))
    out$welch <- list(t = unname(welch$statistic), df = unname(welch$parameter), p = welch$p.value)
  ranks <- if (pair$n) signed_ranks(pair$whole, pair$denominator)
  if (!is.null(ranks)) out$wilcoxon <- ranks
  normality <- shapiro(pair$d)
  if (!is.null(normality)) out$normality <- normality
  out
}

# Rows: participants with all methods.
omnibus <- function(rows) {
  complete <- rows[stats::complete.cases(rows), , drop = FALSE]
  out <- list(n = nrow(complete), n_incomplete = sum(rowSums(!is.na(rows)) > 0) - nrow(complete))
  if (nrow(complete) < 2) return(out)
  friedman <- friedman.test(complete)
  if (!is.nan(friedman$statistic))
    out$friedman <- list(chi2 = unname(friedman$statistic), df = unname(friedman$parameter), p = friedman$p.value,
                         kendall_w = unname(friedman$statistic) / (nrow(complete) * (ncol(complete) - 1)))
  k <- ncol(complete); n <- nrow(complete)
  grand <- mean(complete)
  conditions <- n * sum((colMeans(complete) - grand)^2)
  subjects <- k * sum((rowMeans(complete) - grand)^2)
  error <- sum((complete - outer(rowMeans(complete), colMeans(complete), "+") + grand)^2)
  if (error < 1e-20) return(out)
  f <- conditions / (k - 1) / (error / ((k - 1) * (n - 1)))
  tail <- function(e) pf(f, e * (k - 1), e * (k - 1) * (n - 1), lower.tail = FALSE)
  # Greenhouse and Geisser by the covariance of contrasts; Huynh and Feldt 1976.
  contrasts <- contr.helmert(k); contrasts <- sweep(contrasts, 2, sqrt(colSums(contrasts^2)), "/")
  s <- t(contrasts) %*% cov(complete) %*% contrasts
  gg <- sum(diag(s))^2 / ((k - 1) * sum(s^2))
  rest <- n - 1 - (k - 1) * gg
  hf <- if (rest < 1e-9 * n) NA else (n * (k - 1) * gg - 2) / ((k - 1) * rest)
  out$anova <- list(f = f, df1 = k - 1, df2 = (k - 1) * (n - 1), p = tail(1), epsilon_gg = gg, p_gg = tail(gg),
                    epsilon_hf = if (is.na(hf)) NA else min(1, hf),
                    epsilon_hf_uncapped = hf, p_hf = if (is.na(hf)) NA else tail(min(1, hf)),
                    partial_eta2 = conditions / (conditions + error),
                    generalised_eta2 = conditions / (conditions + subjects + error))
  out
}

# A family of tests, each list(label, n, estimate, ci, p, right, ...), decided as an intersection-union test or after
# Holm.
decided <- function(id, tests, decision, testable = TRUE) {
  p <- vapply(tests, function(test) as.numeric(test$p), 0)
  right <- vapply(tests, function(test) isTRUE(test$right), NA)
  holm <- corrected(p, "holm")
  alone <- !is.na(p) & p < alpha & right
  after <- !is.na(p) & holm < alpha & right
  holds <- if (decision == "holm") after else alone
  for (i in seq_along(tests)) {
    tests[[i]]$right <- NULL
    tests[[i]] <- c(tests[[i]], list(p_holm = holm[i], stars = stars(p[i]), stars_holm = stars(holm[i]), holds = holds[i],
                                     holds_holm = after[i], against = !is.na(p[i]) && holm[i] < alpha && !right[i]))
  }
  claim <- if (all(is.na(p))) NA else max(ifelse(is.na(p) | !right, 1, if (decision == "holm") holm else p))
  status <- if (is.na(claim)) "no data" else if (all(holds)) "supported" else if (any(after)) "partly supported" else "not supported"
  list(id = id, family = length(tests), status = if (testable) status else "not testable", confirmed = sum(holds),
       confirmed_holm = sum(after), p_claim = claim, tests = tests)
}

over_six <- function(claims) {
  p <- vapply(claims, function(one) if (one$status == "not testable") NA else as.numeric(one$p_claim), 0)
  holm <- p.adjust(c(ifelse(is.na(p), 1, p), rep(1, 6 - length(p))), "holm")
  for (i in seq_along(claims)) claims[[i]]$p_claim_of_six <- if (is.na(p[i])) NA else holm[i]
  claims
}
