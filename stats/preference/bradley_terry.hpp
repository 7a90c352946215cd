#pragma once
/// Bradley and Terry's model of paired comparisons (1952): P(i beats j) = 1 / (1 + exp(lambda_j - lambda_i)).

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/preference/logit_fit.hpp"
#include "stats/result.hpp"

namespace stats {

/// Decides if the strengths are finite (Ford 1957). They are if, for each split of the items into two sets,
/// each set has a win over the other.
enum class Connection {
  Strong,     ///< finite maximum of the likelihood
  Separated,  ///< all items are linked by comparisons, but some win or lose every comparison with the others:
              ///< infinite strengths
  None,       ///< two groups of items were never compared with each other
};
struct ConnectionReport {
  Connection connection = Connection::Strong;
  std::string reason;  ///< e.g. "item 5 wins every comparison with the others"; empty when Strong
};
/// `wins`: items by items, row after row; entry (i, j) is how often i was preferred to j.
/// std::invalid_argument unless items >= 1 and there are items^2 entries, all finite and >= 0, and 0 for (i,
/// i).
ConnectionReport connection(std::span<const double> wins, int items);

enum class BradleyTerryMethod {
  MaximumLikelihood,
  BiasReduced,  ///< Firth 1993: finite even if items are separated
  Automatic,    ///< maximum likelihood if it is finite, else bias reduced
};

struct PairDifference {
  int i = 0, j = 0;       ///< items, from 0, i < j
  double difference = 0;  ///< lambda_i - lambda_j of the items' strengths, logits
  double se = 0;
  double se_independent = 0;   ///< standard error that treats answers as independent
  std::array<double, 2> ci{};  ///< Wald interval
  double p = 0;                ///< p of the two-sided Wald test
  double probability = 0;      ///< probability that i is preferred to j
  std::array<double, 2> probability_ci{};
};

struct BradleyTerry {
  int items = 0;
  double comparisons = 0;
  bool bias_reduced = false;
  std::string why_bias_reduced;  ///< why Automatic chose bias reduction; empty if it did not
  double confidence = 0.95;
  std::vector<double> lambda_ref1, se_ref1;  ///< strengths less the first item's, their standard errors
  std::vector<double> covariance_ref1;  ///< items by items, row after row; the first row and column are 0
  std::vector<double> lambda_sum0, se_sum0;    ///< strengths that sum to 0, and their standard errors
  std::vector<std::array<double, 2>> ci_sum0;  ///< Wald intervals
  std::vector<double> se_sum0_independent;     ///< standard errors of lambda_sum0 that treat answers as
                                               ///< independent
  std::vector<double> worth;                   ///< exp(lambda), sum 1
  /// Degrees of freedom of standard errors over people, which take each person's answers as one cluster
  /// (people_errors()). Empty if the standard errors treat answers as independent.
  std::optional<double> people_df;
  std::string why_independent;  ///< why a fit of single trials has the errors of independent answers; else
                                ///< empty
  /// Wald's test of equal strengths with errors over people, as Hotelling's T2.
  struct PeopleTest {
    double f = 0, df1 = 0, df2 = 0, p = 0;
  };
  std::optional<PeopleTest> equal_over_people;
  double log_likelihood = 0;  ///< leaves out the binomial coefficients
  /// Goodness of fit: deviance against one free proportion for each pair; gof_p is empty if gof_df is 0.
  double gof_deviance = 0;
  int gof_df = 0;
  std::optional<double> gof_p;
  /// Likelihood-ratio test of equal strengths.
  double lrt_chi2 = 0;
  int lrt_df = 0;
  double lrt_p = 0;
  std::vector<PairDifference> pairs;  ///< all pairs, also those never compared directly
};

/// Fits the model to counts of wins. Refused: fewer than two items, no comparison, items never compared, and
/// for MaximumLikelihood an infinite estimate (the reason names the items). For BiasReduced, likelihood-ratio
/// tests use the bias-reduced strengths in the ordinary likelihood. std::invalid_argument as for
/// connection(), and for a confidence outside (0, 1).
Result<BradleyTerry> bradley_terry(std::span<const double> wins, int items,
                                   BradleyTerryMethod method = BradleyTerryMethod::Automatic,
                                   double confidence = 0.95);

/// Fits single trials. Strengths and likelihood ratios are those of the trials' win counts. Standard errors,
/// intervals and Wald tests take each person's answers as one cluster (people_errors()) if the data allow it.
/// Those of bias-reduced strengths treat answers as independent.
Result<BradleyTerry> bradley_terry(std::span<const Comparison> trials, int items,
                                   BradleyTerryMethod method = BradleyTerryMethod::Automatic,
                                   double confidence = 0.95);

}  // namespace stats
