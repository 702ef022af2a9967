//! Measures as a table.

use adit_nlos::judging::Judgement;
use adit_nlos::measures::Measures;
use std::fmt::Write;

/// A model with a network.
pub const NETWORK: &str = "network";
/// The discriminant of features made by hand.
pub const BASELINE: &str = "baseline";

/// A model's, with others beside it; each with its name.
pub fn measures(model: (&str, &Measures), beside: &[(&str, &Measures)]) -> String {
    let mut text = format!("ranges      {}\n", model.1.ranges);
    let _ = writeln!(
        text,
        "            accuracy  balanced  macro F1 | LOS or not: accuracy  balanced  F1     calibration error"
    );
    for (name, m) in [model].iter().chain(beside) {
        let b = &m.binary;
        let _ = writeln!(
            text,
            "{name:<11} {:<9.3} {:<9.3} {:<8.3} |             {:<9.3} {:<9.3} {:<6.3} {:.3}",
            m.accuracy,
            m.balanced_accuracy,
            m.macro_f1,
            b.accuracy,
            b.balanced_accuracy,
            b.f1,
            b.calibration_error
        );
    }
    let (_, model) = model;
    let names = columns(model.classes.iter().map(|class| format!("{class:>8}")));
    let _ = writeln!(text, "true\\told  {names}");
    for (class, row) in model.classes.iter().zip(&model.confusion) {
        let counts = columns(row.iter().map(|count| format!("{count:>8}")));
        let _ = writeln!(text, "{class:<11}{counts}");
    }
    text + &each(model)
}

/// Each class against the rest.
fn each(model: &Measures) -> String {
    let mut text = "one against the rest: accuracy  recall   precision  F1\n".to_owned();
    for class in &model.each {
        let _ = writeln!(
            text,
            "{:<21} {:<9.3} {:<8.3} {:<10.3} {:.3}",
            class.class, class.accuracy, class.recall, class.precision, class.f1
        );
    }
    let mean = &model.mean;
    let _ = writeln!(text, "{:<21} {:<9.3} {:<19.3} {:.3}", "mean", mean.accuracy, mean.recall, mean.f1);
    text
}

/// The same, and group by group.
pub fn judgement(judgement: &Judgement, network: bool) -> String {
    let name = if network { NETWORK } else { BASELINE };
    let beside = [(BASELINE, &judgement.baseline)];
    let mut text = measures((name, &judgement.model), if network { &beside } else { &[] });
    if let Some(filtered) = &judgement.filtered {
        text += "\nwith what was told of each link before kept in mind\n";
        text += &measures(("filtered", filtered), &[]);
        text += "\n";
    }
    let names = columns(judgement.model.classes.iter().map(|class| format!("{class:>8}")));
    let _ = writeln!(text, "geometry    true    ranges{names}");
    for group in &judgement.groups {
        let shares = columns(group.told.iter().map(|share| format!("{share:>8.2}")));
        let _ = writeln!(text, "{:<11} {:<7} {:>6}{shares}", group.group, group.class, group.ranges);
    }
    text
}

/// Cells side by side.
fn columns(cells: impl Iterator<Item = String>) -> String {
    cells.fold(String::new(), |line, cell| line + &cell)
}
