# Each person's own contour with partial pooling (stats/ptpe/people_fit.hpp), on made pilots:
#   plain    ordinal::clmm (probit, Laplace) with a random intercept and a random slope for delta. With
#            m = q = 0 and no lapses this is the model; a, b, their spread and people's curves follow from it.
#   whole    all of the model, written out: thresholds held at the level, m, q, drift, lapses, both priors; the
#            likelihood by a product rule of 40 x 40 Gauss-Legendre nodes over each person's effects, which knows
#            nothing of modes; optim.
# Prints people_contours.json:
#   Rscript people_contours.R > people_contours.json
suppressMessages(library(ordinal))
set.seed(20)
num <- function(x) sprintf("%.10g", x)
list_of <- function(x) paste0("[", paste(x, collapse = ", "), "]")
settings <- subset(expand.grid(delta = c(0, 5, 10, 15, 20), mu = c(10, 20, 30, 40, 50)), delta < mu)

pilot <- function(people, repeats, a, b, sd_a, sd_b, rho, k = 3.4, m = 0, q = 0, drift = 0, lapse = 0) {
  rows <- NULL
  for (person in seq_len(people)) {
    z <- rnorm(2)
    own_a <- log(a) + sd_a * z[1]
    own_b <- b + sd_b * (rho * z[1] + sqrt(1 - rho^2) * z[2])
    order <- sample(rep(seq_len(nrow(settings)), repeats))
    for (i in seq_along(order)) {
      s <- settings[order[i], ]
      v <- log(s$mu) - own_a - own_b * s$delta
      x <- 4 + v * (k + m * s$delta + q * v) + drift * ((i - 1) / (length(order) - 1) - 0.5) + rnorm(1)
      score <- pmin(7, pmax(1, round(x)))
      if (runif(1) < lapse) score <- sample(7, 1)
      rows <- rbind(rows, data.frame(person = person, mu = s$mu, delta = s$delta, position = i - 1, score = score))
    }
  }
  rows
}

# The location at which a person's expected answer is the level.
level_location <- function(theta, scores, level)
  uniroot(function(l) scores[1] + sum(diff(scores) * pnorm(l - theta)) - level, c(-50, 50), tol = 1e-13)$root

plain <- function(rows, level) {
  rows$y <- factor(rows$score, ordered = TRUE)
  rows$p <- factor(rows$person)
  rows$x <- log(rows$mu) - mean(log(rows$mu))
  rows$d <- rows$delta / 10
  fit <- clmm(y ~ x + d + (1 + d | p), data = rows, link = "probit", Hess = FALSE,
              control = clmm.control(maxIter = 500, gradTol = 1e-6))
  scores <- sort(unique(rows$score))
  k <- fit$beta[["x"]]
  spread <- VarCorr(fit)$p
  own <- ranef(fit)$p
  log_a <- level_location(fit$Theta[1, ], scores, level) / k + mean(log(rows$mu))
  b <- -fit$beta[["d"]] / k / 10
  list(kind = "plain", a = exp(log_a), b = b, k = k, sd_log_a = sqrt(spread[1, 1]) / k,
       sd_b = sqrt(spread[2, 2]) / k / 10, correlation = cov2cor(spread)[1, 2], log_likelihood = as.numeric(logLik(fit)),
       drift = 0, lapse = 0, m = 0, q = 0,
       own_log_a = log_a - own[, 1] / k, own_b = b - own[, 2] / k / 10)
}

# Gauss-Legendre nodes on [-1, 1] by the eigenvalues of the Jacobi matrix (Golub and Welsch).
legendre <- function(n) {
  i <- seq_len(n - 1)
  jacobi <- matrix(0, n, n)
  jacobi[cbind(i, i + 1)] <- jacobi[cbind(i + 1, i)] <- i / sqrt(4 * i^2 - 1)
  e <- eigen(jacobi, symmetric = TRUE)
  list(x = e$values, w = 2 * e$vectors[1, ]^2)
}
rule <- legendre(40)
reach <- 5.5
grid <- expand.grid(i = 1:40, j = 1:40)
u1 <- reach * rule$x[grid$i]
u2 <- reach * rule$x[grid$j]
log_w <- log(reach^2 * rule$w[grid$i] * rule$w[grid$j]) + dnorm(u1, log = TRUE) + dnorm(u2, log = TRUE)

whole <- function(rows, level, start) {
  scores <- sort(unique(rows$score))
  c_of <- match(rows$score, scores)
  x <- log(rows$mu)
  xm <- mean(x)
  d <- rows$delta / 10
  dm <- mean(d)
  t <- rows$position / max(rows$position) - 0.5
  g <- length(scores) - 2
  by_person <- split(seq_len(nrow(rows)), rows$person)
  read <- function(p) {
    gaps <- c(0, cumsum(exp(p[seq_len(g)])))
    r <- p[-seq_len(g)]
    theta <- gaps - level_location(gaps, scores, level)
    list(theta = theta, alpha = r[1], beta = r[2], k = r[3], m = r[4], q = r[5], drift = r[6], sa = exp(r[7]),
         sb = exp(r[8]), rho = tanh(r[9]), lapse = 0.005 + 0.495 * r[10]^2 / (1 + r[10]^2), root = r[10])
  }
  each <- function(p) {
    e1 <- p$sa * u1
    e2 <- p$sb * (p$rho * u1 + sqrt(1 - p$rho^2) * u2)
    upper <- c(p$theta, Inf)
    lower <- c(-Inf, p$theta)
    lapply(by_person, function(of) {
      g <- log_w
      for (i in of) {
        v <- x[i] - xm - p$alpha - e1 - (p$beta + e2) * (d[i] - dm)
        l <- v * (p$k + p$m * (d[i] - dm) + p$q * v) + p$drift * t[i]
        g <- g + log((1 - p$lapse) * (pnorm(upper[c_of[i]] - l) - pnorm(lower[c_of[i]] - l)) + p$lapse / 7)
      }
      top <- max(g)
      w <- exp(g - top)
      list(value = top + log(sum(w)), e1 = sum(w * e1) / sum(w), e2 = sum(w * e2) / sum(w))
    })
  }
  value <- function(v) {
    p <- read(v)
    -sum(sapply(each(p), `[[`, "value")) - log(p$sa) - log(p$sb) - log(1 - p$rho^2) / 2 + p$root^2 / 2
  }
  fit <- nlminb(start(g), value, control = list(rel.tol = 1e-11, iter.max = 300, eval.max = 500))
  p <- read(fit$par)
  own <- each(p)
  e1 <- sapply(own, `[[`, "e1")
  e2 <- sapply(own, `[[`, "e2")
  b <- p$beta / 10
  log_a <- p$alpha + xm - b * dm * 10
  va <- p$sa^2 - 2 * dm * p$rho * p$sa * p$sb + dm^2 * p$sb^2
  list(kind = "whole", a = exp(log_a), b = b, k = p$k - p$m * dm, sd_log_a = sqrt(va), sd_b = p$sb / 10,
       correlation = (p$rho * p$sa * p$sb - dm * p$sb^2) / sqrt(va) / p$sb,
       log_likelihood = sum(sapply(own, `[[`, "value")), drift = p$drift, lapse = p$lapse, m = p$m / 10, q = p$q,
       own_log_a = p$alpha + e1 + xm - (p$beta + e2) * dm, own_b = (p$beta + e2) / 10)
}

start <- function(g) c(rep(-0.1, g), 0.1, 0.2, 3.4, 0, 0, 0, log(0.15), log(0.06), 0, 0.2)
show <- function(name, rows, r, last) {
  cat(sprintf('  {"name": "%s", "kind": "%s", "level": %s,\n', name, r$kind, num(r$level)))
  for (key in c("person", "mu", "delta", "position", "score")) cat(sprintf('   "%s": %s,\n', key, list_of(rows[[key]])))
  for (key in c("a", "b", "k", "m", "q", "drift", "lapse", "sd_log_a", "sd_b", "correlation", "log_likelihood"))
    cat(sprintf('   "%s": %s,\n', key, num(r[[key]])))
  cat(sprintf('   "own_log_a": %s,\n   "own_b": %s}%s\n', list_of(num(r$own_log_a)), list_of(num(r$own_b)),
              if (last) "" else ","))
}

cases <- list(
  list("16 people, one rating of each setting", pilot(16, 1, 24, 0.02, 0.3, 0.02, -0.3), 4, plain),
  list("12 people, three ratings", pilot(12, 3, 20, 0.03, 0.3, 0.02, 0), 4, plain),
  list("24 people at level 5", pilot(24, 1, 28, 0.01, 0.25, 0.015, 0), 5, plain),
  list("8 people with lapses and drift", pilot(8, 1, 24, 0.02, 0.2, 0.01, -0.3, 3.4, 0.05, 0.5, -1, 0.08), 4, whole),
  list("12 people at level 4.5", pilot(12, 1, 20, 0.03, 0.15, 0.005, 0, 3.4, 0.1, 0.5, 0.5, 0.02), 4.5, whole))
cat(sprintf('{"made_by": "R %s, ordinal %s", "cases": [\n', getRversion(), packageVersion("ordinal")))
for (i in seq_along(cases)) {
  one <- cases[[i]]
  r <- if (identical(one[[4]], plain)) plain(one[[2]], one[[3]]) else whole(one[[2]], one[[3]], start)
  r$level <- one[[3]]
  show(one[[1]], one[[2]], r, i == length(cases))
}
cat("]}\n")
