# The form of a pilot's curve by nls and a jackknife over people, reverse coders by lm, and drift by lm and t.test, on
# made pilots with an exponential, a saturating and a hinged threshold. Prints pilot_form.json:
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

study <- function(people, threshold, drift) {
  rows <- pilot(people, threshold, drift)
  curve <- 26 * exp(0.02 * rows$delta)
  near <- rows[curve <= 50 & rows$mu * 2.46 >= curve, ]
  near$e <- (near$delta - 10) / 10
  plane <- coef(lm(I(score - 4) ~ log(mu) + e + I(e^2), near))
  slope <- plane[[2]]
  whole <- fitted_bend(near, c(l = -plane[[1]] / slope, s = -plane[[3]] / slope, g = -plane[[4]] / slope, k = slope,
                               m = 0, q = 0))
  without <- sapply(seq_len(people), function(p) fitted_bend(near[near$person != p, ], whole)["g"])
  se <- sqrt((people - 1) / people * sum((without - mean(without))^2))
  t <- whole[["g"]] / se
  slopes <- sapply(seq_len(people), function(p)
    summary(lm(score ~ log2(mu) + factor(delta), rows[rows$person == p, ]))$coefficients["log2(mu)", "t value"])
  drifts <- sapply(seq_len(people), function(p) {
    mine <- rows[rows$person == p, ]
    mine$others <- mapply(function(mu, delta)
      mean(rows$score[rows$person != p & rows$mu == mu & rows$delta == delta]), mine$mu, mine$delta)
    coef(lm(I(score - others) ~ I(position / 20), mine))[[2]]
  })
  over <- t.test(drifts)
  sprintf('{"people": %d, "rows": %s, "c": %s, "se": %s, "p": %s, "slopes_t": %s, "drift": %s, "drift_p": %s}',
          people, list_of(as.vector(t(as.matrix(rows)))), num(whole[["g"]]), num(se),
          num(2 * pt(-abs(t), people - 1)), list_of(num(slopes)), num(over$estimate[[1]]), num(over$p.value))
}
studies <- c(study(12, function(d) 23.68 * exp(0.02 * d), 0), study(16, function(d) 24 + 14 * (1 - exp(-d / 5)), -2),
             study(24, function(d) 24 + 1.2 * pmax(0, d - 10), 1))
cat(sprintf('{"r": "%s", "script": "pilot_form.R", "studies": [\n%s]}\n', R.version.string,
            paste(studies, collapse = ",\n")))
