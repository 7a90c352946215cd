#pragma once
/// The Perception Threshold for Physical Process Elapsing (ViP-Fluid paper, section 4.1, Eq. 11).

#include "stats/fps_window.hpp"

namespace stats {

/// a > 0 in frames per second, b in seconds per frame. The defaults are the paper's PTPE@4.0, the curve for a
/// mean rating of 4.0.
struct PtpeModel {
  double a = 23.68;
  double b = 0.02;
  FpsMean mean = FpsMean::Harmonic;  ///< which mean of the frame rate mu was in the fit; the paper does not
                                     ///< state it
};

/// mu(delta) = a exp(b delta): the frame rate that is just satisfactory at a standard deviation delta (both
/// in frames/s).
double ptpe_threshold(const PtpeModel& model, double fps_sd);

/// tau = mu - a exp(b delta) in frames per second (Eq. 11); negative if the frame rate is too low, so that
/// the solver must save work.
double ptpe_tolerance(const PtpeModel& model, double fps_mean, double fps_sd);

/// tau of the frames shown, using the kind of mean that the model was fitted to.
double ptpe_tolerance(const PtpeModel& model, const FpsMoments& shown);

/// The lowest probability that the solver solves a particle: beta = exp(2 b tau) with tau clamped to at most
/// 0, so that 0 < beta <= 1 (Algorithm 3, line 8). Returns 1 if b < 0, since beta would exceed 1.
double activation_floor(const PtpeModel& model, double tolerance);

}  // namespace stats
