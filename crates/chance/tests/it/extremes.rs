//! Probabilities from certain to impossible, degrees of freedom from none to more than can be counted.

mod tails;
