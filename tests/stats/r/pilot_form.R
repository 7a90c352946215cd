# What fit-ptpe makes of a pilot, by nls and a jackknife over people: the direct estimate with its intervals, the band
# of the solver's file, the form of the curve; reverse coders by lm, drift by lm and t.test. On made pilots with an
# exponential, a saturating and a hinged threshold and one of 6 people whose curve leaves the settings. Prints
# pilot_form.json:
#   Rscript pilot_form.R > pilot_form.json
set.seed(11)
num <- function(x) sprintf("%.17g", x)
list_of <- function(x) paste0("[", paste(x, collapse = ", "), "]")
settings <- subset(expand.grid(delta = c(0, 5, 10, 15, 20), mu = c(10, 20, 30, 40, 50)), delta < mu)

pilot <- function(people, threshold, drift) {
  rows <- NULL
  for (person in seq_len(people)) {
    order <- sample(nrow(settings))
    own <- rnorm(1, sd = 0.5)
    for (i in seq_along(order)) {
      s <- settings[order[i], ]
      x <- 4 + 0.14 * (s$mu - threshold(s$delta)) + own + drift * ((i - 1) / 20 - 0.5) + rnorm(1)
      rows <- rbind(rows, data.frame(person = person, mu = s$mu, delta = s$delta, position = i - 1,
                                     score = pmin(7, pmax(1, round(x)))))
    }
  }
  rows
}

# Fits the surface that stats/ptpe/form_test.hpp defines to the settings near 26 exp(0.02 delta).
fitted_bend <- function(rows, start) {
  fit <- nls(score ~ 4 + (log(mu) - l - s * e - g * e^2) * (k + m * e + q * (log(mu) - l - s * e - g * e^2)),
             data = rows, start = as.list(start), control = nls.control(maxiter = 500, tol = 1e-7, minFactor = 1e-12))
  coef(fit)
}

control <- function(tol) nls.control(maxiter = 500, tol = tol, minFactor = 1e-12, nDcentral = TRUE)
deviations <- c(0, 5, 10, 15, 20)

# The surface of stats/ptpe/direct_fit.hpp, with d = delta / 10.
direct_fit <- function(rows, start = NULL) {
  rows$d <- rows$delta / 10
  if (is.null(start)) {
    plane <- coef(lm(I(score - 4) ~ log(mu) + d, rows))
    start <- c(l = -plane[[1]] / plane[[2]], b = -plane[[3]] / plane[[2]], k = plane[[2]], m = 0, q = 0)
  }
  coef(nls(score ~ 4 + (log(mu) - l - b * d) * (k + m * d + q * (log(mu) - l - b * d)), data = rows,
           start = as.list(start), control = control(1e-8)))
}
along <- function(fit, delta) fit[["l"]] + fit[["b"]] * delta / 10  # log mu(delta)

# The rows without the deviations at which the curve lies more than 15 % outside the frame rates shown. The
# three nearest deviations always stay.
reached <- function(rows) {
  log_mu <- along(direct_fit(rows), deviations)
  shown <- sapply(deviations, function(delta) range(log(rows$mu[rows$delta == delta])))
  distance <- pmax(log_mu - shown[2, ], shown[1, ] - log_mu)
  distance[distance <= log(1.15)] <- 0
  rows[rows$delta %in% deviations[distance <= sort(distance)[3]], ]
}
near_enough <- function(rows) rows[log(rows$mu) <= log(2.46) + along(direct_fit(rows), rows$delta), ]

# Mean of a rating that is normal about x, rounded, and limited to 1 to 7. This function S has S(4) = 4.
held_mean <- function(x, sd) 1 + Reduce(`+`, lapply(1:6, function(j) pnorm((x - j - 0.5) / sd)))
error_sd <- function(rows) {
  settings <- Filter(function(own) mean(own) >= 2.5 && mean(own) <= 5.5, split(rows$score, paste(rows$mu, rows$delta)))
  squares <- sum(sapply(settings, function(own) sum((own - mean(own))^2)))
  sqrt(max(squares / sum(lengths(settings) - 1) - 1 / 12, 0.1))
}
# The surface of stats/ptpe/scale_end_fit.hpp. Here u is the difference of roots of frames/s. There it has a
# factor more, which only scales k.
scale_end_fit <- function(rows, sd, start) {
  rows$d <- rows$delta / 10
  coef(nls(score ~ held_mean(4 + (sqrt(mu) - exp((l + b * d) / 2)) * (k + m * d + q * (sqrt(mu) - exp((l + b * d) / 2))), sd),
           data = rows, start = as.list(start), control = control(1e-6)))
}

# Ends of Student's t interval over people of each value that `of` makes of a fit.
jackknife_t <- function(whole, fits, of) {
  n <- length(fits)
  without <- sapply(fits, of)
  if (is.null(dim(without))) without <- matrix(without, 1)
  se <- sqrt((n - 1) / n * rowSums((without - rowMeans(without))^2))
  list(low = of(whole) - qt(0.975, n - 1) * se, high = of(whole) + qt(0.975, n - 1) * se)
}

estimates <- function(rows, people) {
  kept <- reached(rows)
  near <- near_enough(kept)
  direct <- direct_fit(near)
  fits <- lapply(seq_len(people), function(p) direct_fit(near[near$person != p, ], direct))
  a <- jackknife_t(direct, fits, function(fit) fit[["l"]])
  b <- jackknife_t(direct, fits, function(fit) fit[["b"]] / 10)
  sd <- error_sd(kept)
  root <- exp(along(direct, 10) / 2)
  start <- c(direct[c("l", "b")], k = 2 * (direct[["k"]] + direct[["m"]]) / root, m = 0, q = 0)
  whole <- scale_end_fit(kept, sd, start)
  band <- jackknife_t(whole, lapply(seq_len(people), function(p) scale_end_fit(kept[kept$person != p, ], sd, whole)),
                      function(fit) along(fit, deviations))
  sprintf('"a": %s, "a_ci": %s, "b": %s, "b_ci": %s, "out_of_reach": %s, "band_low": %s, "band_high": %s', num(exp(direct[["l"]])),
          list_of(num(exp(c(a$low, a$high)))), num(direct[["b"]] / 10), list_of(num(c(b$low, b$high))),
          list_of(setdiff(deviations, kept$delta)), list_of(num(exp(band$low))), list_of(num(exp(band$high))))
}

# The test of the form about 26 exp(0.02 delta).
form_of <- function(rows, people) {
  curve <- 26 * exp(0.02 * rows$delta)
  near <- rows[curve <= 50 & rows$mu * 2.46 >= curve, ]
  near$e <- (near$delta - 10) / 10
  plane <- coef(lm(I(score - 4) ~ log(mu) + e + I(e^2), near))
  slope <- plane[[2]]
  whole <- fitted_bend(near, c(l = -plane[[1]] / slope, s = -plane[[3]] / slope, g = -plane[[4]] / slope, k = slope,
                               m = 0, q = 0))
  without <- sapply(seq_len(people), function(p) fitted_bend(near[near$person != p, ], whole)["g"])
  se <- sqrt((people - 1) / people * sum((without - mean(without))^2))
  sprintf('"c": %s, "se": %s, "p": %s', num(whole[["g"]]), num(se), num(2 * pt(-abs(whole[["g"]] / se), people - 1)))
}

study <- function(people, threshold, drift, form = TRUE) {
  rows <- pilot(people, threshold, drift)
  slopes <- sapply(seq_len(people), function(p)
    summary(lm(score ~ log2(mu) + factor(delta), rows[rows$person == p, ]))$coefficients["log2(mu)", "t value"])
  drifts <- sapply(seq_len(people), function(p) {
    mine <- rows[rows$person == p, ]
    mine$others <- mapply(function(mu, delta)
      mean(rows$score[rows$person != p & rows$mu == mu & rows$delta == delta]), mine$mu, mine$delta)
    coef(lm(I(score - others) ~ I(position / 20), mine))[[2]]
  })
  over <- t.test(drifts)
  sprintf('{"people": %d, "rows": %s, %s, %s, "slopes_t": %s, "drift": %s, "drift_p": %s}', people,
          list_of(as.vector(t(as.matrix(rows)))), estimates(rows, people), if (form) form_of(rows, people) else '"c": null',
          list_of(num(slopes)), num(over$estimate[[1]]), num(over$p.value))
}
studies <- c(study(12, function(d) 23.68 * exp(0.02 * d), 0), study(16, function(d) 24 + 14 * (1 - exp(-d / 5)), -2),
             study(24, function(d) 24 + 1.2 * pmax(0, d - 10), 1), study(40, function(d) 18 * exp(0.01 * d), 0, FALSE),
             study(6, function(d) 29 * exp(0.035 * d), 0, FALSE))
cat(sprintf('{"r": "%s", "script": "pilot_form.R", "studies": [\n%s]}\n', R.version.string,
            paste(studies, collapse = ",\n")))
