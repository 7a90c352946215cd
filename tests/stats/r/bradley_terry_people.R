# Bradley-Terry's strengths with errors over people, by glm and a sandwich with one person's answers as a cluster, on
# choices of people who have tastes of their own and do not all answer everything. Prints bradley_terry_people.json:
#   Rscript bradley_terry_people.R > bradley_terry_people.json
set.seed(7)
num <- function(x) sprintf("%.17g", x)
list_of <- function(x) paste0("[", paste(x, collapse = ", "), "]")

# Trials: person, first, second, first chosen, position.
study <- function(people, items, taste, answered) {
  strength <- seq(-0.6, 0.6, length.out = items)
  rows <- NULL
  for (person in seq_len(people)) {
    own <- strength + rnorm(items, sd = taste)
    pairs <- t(combn(items, 2))
    pairs <- pairs[sample(nrow(pairs)), ]
    for (i in seq_len(nrow(pairs))) {
      if (runif(1) > answered) next
      pair <- if (runif(1) < 0.5) pairs[i, ] else rev(pairs[i, ])
      rows <- rbind(rows, c(person, pair - 1, rbinom(1, 1, plogis(own[pair[1]] - own[pair[2]] + 0.2)), i))
    }
  }
  rows
}

# Columns: the strengths with the first item at 0, then the bias to the first interval, then its drift about
# the mean position.
design <- function(rows, items, terms) {
  x <- matrix(0, nrow(rows), items)
  x[cbind(seq_len(nrow(rows)), rows[, 2] + 1)] <- 1
  x[cbind(seq_len(nrow(rows)), rows[, 3] + 1)] <- -1
  x <- x[, -1]
  if (terms > 0) x <- cbind(x, 1)
  if (terms > 1) x <- cbind(x, rows[, 5] - mean(rows[, 5]))
  x
}

sandwich <- function(fit, x, person) {
  pull <- rowsum(x * (fit$y - fitted(fit)), person)
  people <- nrow(pull)
  vcov(fit) %*% crossprod(pull) %*% vcov(fit) * people / (people - 1)
}

fitted_with <- function(rows, items, terms) {
  x <- design(rows, items, terms)
  fit <- glm(rows[, 4] ~ 0 + x, family = binomial, control = glm.control(epsilon = 1e-14, maxit = 100))
  list(fit = fit, covariance = sandwich(fit, x, rows[, 1]))
}

term <- function(rows, items, terms, df) {
  model <- fitted_with(rows, items, terms)
  last <- length(coef(model$fit))
  se <- sqrt(model$covariance[last, last])
  sprintf('{"estimate": %s, "se": %s, "se_independent": %s, "p": %s}', num(coef(model$fit)[last]), num(se),
          num(sqrt(vcov(model$fit)[last, last])), num(2 * pt(-abs(coef(model$fit)[last] / se), df)))
}

case <- function(people, items, taste, answered) {
  rows <- study(people, items, taste, answered)
  model <- fitted_with(rows, items, 0)
  df <- length(unique(rows[, 1])) - 1
  k <- items - 1
  # Matrices from the coefficients to strengths that sum to 0, and to the differences of all pairs.
  centre <- rbind(0, diag(k)) - matrix(1 / items, items, k)
  pairs <- combn(items, 2)
  contrast <- t(apply(pairs, 2, function(p) { v <- numeric(items); v[p] <- c(1, -1); v[-1] }))
  errors <- function(m, covariance) sqrt(diag(m %*% covariance %*% t(m)))
  difference <- as.vector(contrast %*% coef(model$fit))
  se <- errors(contrast, model$covariance)
  t2 <- as.numeric(t(coef(model$fit)) %*% solve(model$covariance, coef(model$fit)))
  f <- t2 * (df + 1 - k) / (k * df)
  sprintf(paste0('{"items": %d, "df": %d, "trials": %s,\n "se_sum0": %s,\n "se_sum0_independent": %s,\n "difference": %s,\n',
                 ' "difference_se": %s,\n "difference_p": %s,\n "half_width": %s,\n "f": %s, "f_p": %s,\n "interval": %s,\n "drift": %s}'),
          items, df, list_of(apply(rows, 1, list_of)), list_of(num(errors(centre, model$covariance))),
          list_of(num(errors(centre, vcov(model$fit)))), list_of(num(difference)), list_of(num(se)),
          list_of(num(2 * pt(-abs(difference / se), df))), list_of(num(qt(0.975, df) * se)), num(f),
          num(pf(f, k, df + 1 - k, lower.tail = FALSE)), term(rows, items, 1, df), term(rows, items, 2, df))
}

cases <- c(case(26, 5, 1.2, 1), case(26, 5, 0, 1), case(14, 4, 0.8, 0.7), case(40, 3, 2, 0.9))
cat(sprintf('{"r": "%s", "script": "bradley_terry_people.R", "cases": [\n%s]}\n', R.version.string, paste(cases, collapse = ",\n")))
