//! How good judgements are.
//!
//! Of the confusion `n_tc` (truth t, told c), with recall `R_c = n_cc / Σ_c n_tc` and precision `P_c = n_cc / Σ_t n_tc`: accuracy `Σ n_cc / Σ n_tc`, balanced accuracy = mean
//! of `R_c`, macro F1 = mean of `F_c = 2 P_c R_c / (P_c + R_c)`. The two-class view asks "not line of sight?": told where `P(LOS) < ½`; its F1 is that of "not line of sight".
//!
//! Expected calibration error (Naeini, Cooper & Hauskrecht 2015; Guo et al. 2017): ten bins of the probability told, `Σ_b n_b/n |share right − mean probability|`, of the class told and
//! of line of sight.

use serde::Serialize;

/// Bins of the reliability.
pub const BINS: usize = 10;

/// Judgements against the truth. Every figure is a share, 0 to 1; a class without rows has recall 0 and is left out of the balanced accuracy and of the macro F1
/// where nothing was told to be of it either.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// Names of the classes, in order of the confusion.
    pub classes: Vec<&'static str>,
    /// Ranges judged.
    pub ranges: usize,
    /// Share told rightly.
    pub accuracy: f64,
    /// Mean over the classes of the share of theirs told rightly.
    pub balanced_accuracy: f64,
    /// Mean over the classes of F1.
    pub macro_f1: f64,
    /// Line of sight or not.
    pub binary: Binary,
    /// Each class against the rest.
    pub each: Vec<ClassMeasures>,
    /// Their means.
    pub mean: Means,
    /// Ranges by true class (row) and class told (column).
    pub confusion: Vec<Vec<usize>>,
    /// Expected calibration error of the class told.
    pub calibration_error: f64,
    /// Mean of −ln of the probability given to the truth.
    pub log_loss: f64,
}

/// One class against the rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassMeasures {
    /// Its name.
    pub class: &'static str,
    /// Its ranges.
    pub ranges: usize,
    /// Share of all ranges of which it is told rightly whether they are of the class.
    pub accuracy: f64,
    /// Share of its ranges told rightly.
    pub recall: f64,
    /// Share of those told to be of the class that are.
    pub precision: f64,
    /// `2 P R / (P + R)`.
    pub f1: f64,
}

/// Means over the classes that there are, as system S4's table 1 has them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Means {
    /// Of the accuracies of each class against the rest: `1 − 2 (1 − accuracy)/n` with n classes.
    pub accuracy: f64,
    /// Of the recalls.
    pub recall: f64,
    /// Of F1.
    pub f1: f64,
}

/// Line of sight or not.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Binary {
    /// Share told rightly.
    pub accuracy: f64,
    /// Mean of the shares of either told rightly.
    pub balanced_accuracy: f64,
    /// F1 of "not line of sight".
    pub f1: f64,
    /// Expected calibration error of `P(LOS)`.
    pub calibration_error: f64,
    /// Of each tenth of `P(LOS)`: ranges, mean probability, share in sight.
    pub reliability: Vec<Bin>,
}

/// One bin of the reliability.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Bin {
    /// Ranges in it.
    pub ranges: usize,
    /// Mean probability told.
    pub probability: f64,
    /// Share of which it was true.
    pub share: f64,
}

impl Measures {
    /// Of judgements: true class (index into `classes`, the first line of sight) and probabilities.
    pub fn of<'a>(
        classes: &[&'static str],
        judged: impl Iterator<Item = (usize, &'a [f32])> + Clone,
    ) -> Self {
        let count = classes.len();
        let mut confusion = vec![vec![0; count]; count];
        let mut two = [[0; 2]; 2];
        let mut loss = 0.0;
        for (truth, probabilities) in judged.clone() {
            confusion[truth][told(probabilities).0] += 1;
            two[usize::from(truth > 0)][usize::from(probabilities[0] < 0.5)] += 1;
            loss -= f64::from(probabilities[truth].max(1e-7)).ln();
        }
        let ranges: usize = confusion.iter().flatten().sum();
        let right = judged.clone().map(|(truth, p)| {
            let (class, probability) = told(p);
            (probability, class == truth)
        });
        let reliability = bins(judged.map(|(truth, p)| (p[0], truth == 0)));
        let each: Vec<ClassMeasures> = (0..count).map(|class| one(classes, &confusion, class)).collect();
        let [seen, rest] = two;
        let two = vec![seen.to_vec(), rest.to_vec()];
        Self {
            classes: classes.to_vec(),
            ranges,
            accuracy: accuracy(&confusion),
            balanced_accuracy: balanced(&confusion),
            macro_f1: macro_f1(&confusion),
            binary: Binary {
                accuracy: accuracy(&two),
                balanced_accuracy: balanced(&two),
                f1: f1(&two, 1),
                calibration_error: calibration_error(&reliability),
                reliability,
            },
            mean: means(&each),
            each,
            calibration_error: calibration_error(&bins(right)),
            log_loss: loss / ranges.max(1) as f64,
            confusion,
        }
    }
}

/// The class of largest probability.
pub fn told(probabilities: &[f32]) -> (usize, f32) {
    let first = (0, f32::NEG_INFINITY);
    probabilities.iter().copied().enumerate().fold(first, |best, now| if now.1 > best.1 { now } else { best })
}

fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

fn accuracy(confusion: &[Vec<usize>]) -> f64 {
    let right = (0..confusion.len()).map(|c| confusion[c][c]).sum();
    share(right, confusion.iter().flatten().sum())
}

fn balanced(confusion: &[Vec<usize>]) -> f64 {
    let there: Vec<usize> =
        (0..confusion.len()).filter(|c| confusion[*c].iter().sum::<usize>() > 0).collect();
    there.iter().map(|c| share(confusion[*c][*c], confusion[*c].iter().sum())).sum::<f64>()
        / there.len().max(1) as f64
}

/// `2 n_cc / (Σ_t n_tc + Σ_c n_tc)`, the same as `2 P R / (P + R)`.
fn f1(confusion: &[Vec<usize>], class: usize) -> f64 {
    let told: usize = confusion.iter().map(|row| row[class]).sum();
    share(2 * confusion[class][class], told + confusion[class].iter().sum::<usize>())
}

/// A class against the rest.
fn one(classes: &[&'static str], confusion: &[Vec<usize>], class: usize) -> ClassMeasures {
    let all: usize = confusion.iter().flatten().sum();
    let right = confusion[class][class];
    let ranges: usize = confusion[class].iter().sum();
    let told: usize = confusion.iter().map(|row| row[class]).sum();
    ClassMeasures {
        class: classes[class],
        ranges,
        accuracy: share(all + 2 * right - ranges - told, all),
        recall: share(right, ranges),
        precision: share(right, told),
        f1: f1(confusion, class),
    }
}

fn means(each: &[ClassMeasures]) -> Means {
    let there = || each.iter().filter(|class| class.ranges > 0);
    let mean = |of: fn(&ClassMeasures) -> f64| there().map(of).sum::<f64>() / there().count().max(1) as f64;
    Means { accuracy: mean(|c| c.accuracy), recall: mean(|c| c.recall), f1: mean(|c| c.f1) }
}

fn macro_f1(confusion: &[Vec<usize>]) -> f64 {
    let touched = |c: &usize| {
        confusion[*c].iter().sum::<usize>() + confusion.iter().map(|row| row[*c]).sum::<usize>() > 0
    };
    let there: Vec<usize> = (0..confusion.len()).filter(touched).collect();
    there.iter().map(|c| f1(confusion, *c)).sum::<f64>() / there.len().max(1) as f64
}

fn bins(told: impl Iterator<Item = (f32, bool)>) -> Vec<Bin> {
    let mut bins = vec![Bin::default(); BINS];
    for (probability, truth) in told {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 10")]
        let bin = &mut bins[((probability * BINS as f32) as usize).min(BINS - 1)];
        bin.ranges += 1;
        bin.probability += f64::from(probability);
        bin.share += f64::from(u8::from(truth));
    }
    for bin in &mut bins {
        bin.probability /= bin.ranges.max(1) as f64;
        bin.share /= bin.ranges.max(1) as f64;
    }
    bins
}

fn calibration_error(bins: &[Bin]) -> f64 {
    let all: usize = bins.iter().map(|bin| bin.ranges).sum();
    bins.iter().map(|bin| share(bin.ranges, all) * (bin.share - bin.probability).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of scikit-learn 1.9.1 for the same judgements (`accuracy_score`, `balanced_accuracy_score`, `f1_score`).
    #[test]
    fn agrees_with_scikit_learn() {
        let judged: [(usize, [f32; 3]); 8] = [
            (0, [0.7, 0.2, 0.1]),
            (0, [0.3, 0.6, 0.1]),
            (1, [0.1, 0.8, 0.1]),
            (1, [0.2, 0.3, 0.5]),
            (1, [0.55, 0.25, 0.2]),
            (2, [0.1, 0.2, 0.7]),
            (2, [0.05, 0.05, 0.9]),
            (2, [0.3, 0.4, 0.3]),
        ];
        let found = Measures::of(&["LOS", "NLOS", "NDP"], judged.iter().map(|(t, p)| (*t, &p[..])));
        assert_eq!(found.confusion, [[1, 1, 0], [1, 1, 1], [0, 1, 2]]);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(found.accuracy, 0.5);
        close(found.balanced_accuracy, 0.5);
        close(found.macro_f1, (0.5 + 1.0 / 3.0 + 2.0 / 3.0) / 3.0);
        // `accuracy_score(y == c, told == c)`, `recall_score`, `precision_score` of the second class.
        let second = &found.each[1];
        close(second.accuracy, 4.0 / 8.0);
        close(second.recall, 1.0 / 3.0);
        close(second.precision, 1.0 / 3.0);
        close(found.mean.accuracy, (6.0 / 8.0 + 4.0 / 8.0 + 6.0 / 8.0) / 3.0);
        close(found.mean.recall, found.balanced_accuracy);
        close(found.mean.f1, found.macro_f1);
        close(found.binary.accuracy, 0.75);
        close(found.binary.balanced_accuracy, 0.5 * (0.5 + 5.0 / 6.0));
        close(found.binary.f1, 10.0 / 12.0);
    }

    #[test]
    fn probabilities_that_hold_have_no_calibration_error() {
        // 3 of 4 with probability 0.75 are in sight.
        let judged: Vec<(usize, [f32; 2])> =
            (0..8).map(|k| (usize::from(k % 4 == 0), [0.75, 0.25])).collect();
        let found = Measures::of(&["LOS", "NLOS"], judged.iter().map(|(t, p)| (*t, &p[..])));
        assert!(found.binary.calibration_error < 1e-12 && found.calibration_error < 1e-12);
        let sure: Vec<(usize, [f32; 2])> = judged.iter().map(|(t, _)| (*t, [1.0, 0.0])).collect();
        let found = Measures::of(&["LOS", "NLOS"], sure.iter().map(|(t, p)| (*t, &p[..])));
        assert!((found.binary.calibration_error - 0.25).abs() < 1e-12);
    }
}
