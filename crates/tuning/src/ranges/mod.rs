//! How ranges err, learnt from ranges of which the distance is known: a [`RangeCorrection`](adit_estimation::ranging::correction::RangeCorrection).

pub mod polynomial;
