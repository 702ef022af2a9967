//! scratch
use adit_nlos::{examples::Examples, folds, judging::*};
fn main() {
    let sets: Vec<_> = std::env::args().skip(1).map(|p| adit_observation::csv_log::labelled::read(p).unwrap()).collect();
    let examples = Examples::of(&sets).unwrap();
    for shrinkage in [0.02, 0.05, 0.1, 0.2, 0.3, 0.5] {
    let folds = folds::by_group(&examples, 1000, 1).unwrap();
    let held = HeldOut::of(&BaselineLearner { shrinkage }, &examples, &folds, &[]).unwrap();
    let t = held.temperature(&examples);
    let m = held.measures(&examples, t);
    println!("{shrinkage} T {t:.2} acc {:.3} bal {:.3} mf1 {:.3} | {:.3} {:.3} {:.3} ece {:.3} {:.3} {:?}", m.accuracy, m.balanced_accuracy, m.macro_f1, m.binary.accuracy, m.binary.balanced_accuracy, m.binary.f1, m.calibration_error, m.binary.calibration_error, m.confusion);
    }
}
