# Reference answers for the rival models (stats/ordinal/rival_fit.hpp, rival_comparison.hpp). Prints rival_models.json:
#   Rscript rival_models.R > rival_models.json
# clmm: log likelihoods and coefficients of package ordinal on ten data sets, five of them in ../oracle, one the wine
#   data of Randall (1989) as that package holds it; lme4: glmer on two-valued answers.
# lapses: a likelihood with lapses written here: the integral over a person's effect is a sum over 161 points, and the
#   maximum is found by optim without derivatives of our own.
# cross_validation: every person of a small study left out, refitted and scored by the same likelihood.
# stacking: weights of package loo. imitation: R2 of lm.
suppressMessages({ library(ordinal); library(lme4); library(loo) })
num <- function(x) sprintf("%.12g", x)
list_of <- function(x) paste0("[", paste(x, collapse = ","), "]")
numbers <- function(x) list_of(num(x))
field <- function(name, value) sprintf('"%s": %s', name, value)
object <- function(...) paste0("{", paste(c(...), collapse = ", "), "}")
standard <- function(x) (x - mean(x)) / sqrt(mean((x - mean(x))^2))

# --- data sets: score (0, 1, ...), person (0, 1, ...), predictors
stored <- function(name) read.csv(file.path("..", "oracle", name))
of_methods <- function(name) {
  d <- stored(name)
  list(name = name, score = match(d$rating, sort(unique(d$rating))) - 1, person = d$participant - min(d$participant),
       x = list(d$method))
}
of_pilot <- function(name, what) {
  d <- stored(name)
  list(name = paste(name, what), score = d$rating - 1, person = d$participant - 1,
       x = list(if (what == "log mu") log(d$fps_mean) else d$fps_sd))
}
simulated <- function(seed, people, settings, sd, lapse = 0, choices = 7) {
  set.seed(seed)
  x <- rep(settings, people)
  person <- rep(seq_len(people) - 1, each = length(settings))
  y <- standard(x) * 1.2 - 0.2 * standard(x)^2 + rnorm(people, sd = sd)[person + 1] + rnorm(length(x))
  score <- pmin(choices - 1, pmax(0, round(y * 1.3 + (choices - 1) / 2)))
  guess <- runif(length(x)) < lapse
  score[guess] <- sample(0:(choices - 1), sum(guess), replace = TRUE)
  list(name = paste("simulated", seed), score = score, person = person, x = list(x))
}
wine_data <- list(name = "wine", score = as.integer(wine$rating) - 1, person = as.integer(wine$judge) - 1,
                  x = list(2 * (wine$temp == "warm") + (wine$contact == "yes")))
rates <- c(10, 14, 20, 25, 30, 40, 50, 60)
sets <- list(of_methods("ordinal_likert16x3.csv"), of_methods("ordinal_likert26x5.csv"), of_methods("ordinal_unused_level.csv"),
             of_pilot("pilot16.csv", "log mu"), of_pilot("pilot16_noisy.csv", "log mu"), of_pilot("pilot16_noisy.csv", "delta"),
             wine_data, simulated(1, 12, rates, 0.5), simulated(2, 30, rates[1:5], 1.2), simulated(3, 20, rates, 0.8, 0, 5))
data_of <- function(d) object(field("name", paste0('"', d$name, '"')), field("choices", max(d$score) + 1),
                              field("score", list_of(d$score)), field("person", list_of(d$person)),
                              field("x", list_of(sapply(d$x, numbers))))
of_clmm <- function(d) {
  v <- standard(d$x[[1]])
  f <- clmm(factor(score) ~ v + I(v^2) + (1 | person), data.frame(score = d$score, v = v, person = factor(d$person)),
            link = "probit", nAGQ = 15, control = clmm.control(gradTol = 1e-8))
  object(field("data", data_of(d)), field("log_likelihood", num(as.numeric(logLik(f)))),
         field("coefficients", numbers(f$beta)), field("thresholds", numbers(f$alpha)),
         field("sd", num(attr(VarCorr(f)$person, "stddev"))))
}
of_lme4 <- function(d, cut) {
  d$score <- as.integer(d$score >= cut)
  v <- standard(d$x[[1]])
  f <- glmer(score ~ v + I(v^2) + (1 | person), data.frame(score = d$score, v = v, person = factor(d$person)),
             family = binomial("probit"), nAGQ = 15, control = glmerControl(tolPwrss = 1e-12, optimizer = "bobyqa",
             optCtrl = list(rhoend = 1e-10)))
  b <- fixef(f)
  object(field("data", data_of(d)), field("coefficients", numbers(b[2:3])), field("threshold", num(-b[1])),
         field("sd", num(attr(VarCorr(f)$person, "stddev"))))
}

# --- the likelihood with lapses, by brute force
u <- seq(-9, 9, length.out = 161)
log_weight <- dnorm(u, log = TRUE) + log(u[2] - u[1])
least_lapse <- 0.005
lapse_of <- function(t) least_lapse + (0.5 - least_lapse) * t^2 / (1 + t^2)
# log P of each person's answers; z: rows x predictors, standardised
people_logs <- function(p, score, scores, person, z, choices) {
  q <- length(scores) - 1
  theta <- cumsum(c(p[1], exp(p[seq_len(q - 1) + 1])))
  b <- p[q + seq_len(ncol(z) + 1)]
  sd <- p[q + ncol(z) + 2]
  lapse <- lapse_of(p[q + ncol(z) + 3])
  v <- z[, 1]
  if (ncol(z) > 1) v <- v - b[3] * z[, 2]
  place <- b[1] * v + b[2] * v^2
  upper <- c(theta, Inf)
  lower <- c(-Inf, theta)
  at <- match(score, scores)
  known <- !is.na(at)
  one <- matrix(0, length(score), length(u))
  centre <- outer(place[known], sd * u, "+")
  one[known, ] <- pnorm(upper[at[known]] - centre) - pnorm(lower[at[known]] - centre)
  logs <- log((1 - lapse) * one + lapse / choices)
  sapply(split(seq_along(score), person), function(rows) {
    g <- colSums(logs[rows, , drop = FALSE]) + log_weight
    max(g) + log(sum(exp(g - max(g))))
  })
}
fit_lapses <- function(score, person, z, choices, prior_sd = 5) {
  scores <- sort(unique(score))
  q <- length(scores) - 1
  cost <- function(p) {
    b <- p[q + seq_len(ncol(z) + 1)]
    theta <- cumsum(c(p[1], exp(p[seq_len(q - 1) + 1])))
    -sum(people_logs(p, score, scores, person, z, choices)) + (sum(theta^2) + sum(b^2)) / (2 * prior_sd^2) +
      p[length(p)]^2 / 2
  }
  theta <- qnorm(cumsum(table(score))[seq_len(q)] / length(score))
  best <- NULL
  for (c2 in if (ncol(z) > 1) c(-0.7, 0, 0.7) else 0) {
    start <- c(theta[1], log(diff(theta)), sign(cor(z[, 1], score)) * 0.7, 0, if (ncol(z) > 1) c2, 0.5, 0.2)
    for (round in 1:3) {
      f <- optim(start, cost, method = "BFGS", control = list(maxit = 1000, reltol = 1e-14))
      start <- f$par
    }
    if (is.null(best) || f$value < best$value) best <- f
  }
  p <- best$par
  b <- p[q + seq_len(ncol(z) + 1)]
  list(par = p, scores = scores, coefficients = b, sd = abs(p[q + ncol(z) + 2]), lapse = lapse_of(p[length(p)]),
       log_likelihood = sum(people_logs(p, score, scores, person, z, choices)))
}
of_lapses <- function(d, choices) {
  z <- sapply(d$x, standard)
  f <- fit_lapses(d$score, d$person, z, choices)
  object(field("data", data_of(d)), field("choices", choices), field("coefficients", numbers(f$coefficients)),
         field("sd", num(f$sd)), field("lapse", num(f$lapse)), field("log_likelihood", num(f$log_likelihood)))
}
small_study <- function() {
  settings <- expand.grid(mu = c(10, 20, 30, 50), delta = c(0, 5, 9))
  set.seed(5)
  people <- 8
  d <- settings[rep(seq_len(nrow(settings)), people), ]
  person <- rep(seq_len(people) - 1, each = nrow(settings))
  y <- 2.2 * (log(d$mu) - 0.05 * d$delta - 3) + rnorm(people, sd = 0.6)[person + 1] + rnorm(nrow(d))
  list(name = "small study", score = pmin(4, pmax(0, round(y + 2))), person = person, x = list(log(d$mu), d$delta))
}
of_cross_validation <- function() {
  d <- small_study()
  z <- sapply(d$x, standard)
  models <- list(ptpe = 1:2, rate = 1, delta = 2)
  scores <- lapply(models, function(columns) sapply(unique(d$person), function(out) {
    x <- z[, columns, drop = FALSE]
    inside <- d$person != out
    f <- fit_lapses(d$score[inside], d$person[inside], x[inside, , drop = FALSE], 5)
    people_logs(f$par, d$score[!inside], f$scores, d$person[!inside], x[!inside, , drop = FALSE], 5)
  }))
  object(field("data", data_of(d)), field("ptpe", numbers(scores$ptpe)), field("rate", numbers(scores$rate)),
         field("delta", numbers(scores$delta)))
}
of_stacking <- function(seed, people, models) {
  set.seed(seed)
  s <- matrix(rnorm(people * models, -30, 3), people) + rnorm(people, sd = 5)
  w <- suppressWarnings(stacking_weights(s, optim_control = list(reltol = 1e-14)))
  object(field("scores", list_of(apply(s, 2, numbers))), field("weights", numbers(as.numeric(w))))
}
of_imitation <- function() {
  d <- expand.grid(mu = c(10, 20, 30, 40, 50), delta = c(0, 3, 6, 9))
  y <- log(d$mu) - 0.03 * d$delta + 0.02 * sin(d$mu)
  one <- summary(lm(y ~ log(mu) + I(log(mu)^2), d))$r.squared
  r2 <- function(c) { v <- log(d$mu) - c * d$delta; summary(lm(y ~ v + I(v^2)))$r.squared }
  two <- optimize(r2, c(0, 0.1), maximum = TRUE, tol = 1e-10)$objective
  object(field("target", numbers(y)), field("x1", numbers(log(d$mu))), field("x2", numbers(d$delta)),
         field("one", num(one)), field("two", num(two)))
}
lines <- c(
  field("r", paste0('"', R.version.string, '"')),
  field("packages", paste0('"ordinal ', packageVersion("ordinal"), ", lme4 ", packageVersion("lme4"), ", loo ",
                           packageVersion("loo"), '"')),
  field("script", '"rival_models.R"'),
  field("clmm", paste0("[\n", paste(sapply(sets, of_clmm), collapse = ",\n"), "]")),
  field("lme4", paste0("[\n", paste(c(of_lme4(sets[[5]], 4), of_lme4(sets[[9]], 3)), collapse = ",\n"), "]")),
  field("lapses", paste0("[\n", paste(c(of_lapses(simulated(6, 14, rates, 0.6, 0.1), 7),
                                        of_lapses(small_study(), 5)), collapse = ",\n"), "]")),
  field("cross_validation", of_cross_validation()),
  field("stacking", list_of(c(of_stacking(7, 24, 4), of_stacking(8, 12, 3)))),
  field("imitation", of_imitation()))
cat(paste0("{", paste(lines, collapse = ",\n"), "}\n"))
