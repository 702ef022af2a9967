//! Measures as a table.

use adit_nlos::judging::Judgement;
use adit_nlos::measures::Measures;
use std::fmt::Write;

/// A model's, with its baseline's beside where there is one to compare.
pub fn measures(model: &Measures, baseline: Option<&Measures>) -> String {
    let mut text = format!("ranges      {}\n", model.ranges);
    let _ = writeln!(
        text,
        "            accuracy  balanced  macro F1 | LOS or not: accuracy  balanced  F1     calibration error"
    );
    let rows =
        [(if baseline.is_some() { "network" } else { "baseline" }, Some(model)), ("baseline", baseline)];
    for (name, measures) in rows {
        let Some(m) = measures else { continue };
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
    let names = columns(model.classes.iter().map(|class| format!("{class:>8}")));
    let _ = writeln!(text, "true\\told  {names}");
    for (class, row) in model.classes.iter().zip(&model.confusion) {
        let counts = columns(row.iter().map(|count| format!("{count:>8}")));
        let _ = writeln!(text, "{class:<11}{counts}");
    }
    text
}

/// The same, and group by group.
pub fn judgement(judgement: &Judgement, network: bool) -> String {
    let mut text = measures(&judgement.model, network.then_some(&judgement.baseline));
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
