//! What `adit calibrate range` tells.

use super::Report;
use adit_tuning::ranges::choice::Choice;
use adit_tuning::ranges::measures::{ClassErrors, Errors};
use anyhow::Result;
use std::fmt::Write as _;

/// The table.
pub(super) fn of(report: &Report) -> Result<String> {
    let Report { data, groups, ranges, learnt, held_out, tests } = report;
    let mut text = format!("data         {}: {ranges} ranges of {groups} groups\n", data.join(", "));
    writeln!(text, "offsets      {}", chosen(&learnt.offsets))?;
    let correction = &learnt.correction;
    if learnt.offsets.chosen != "none" {
        let each = correction.anchors.iter().map(|(anchor, offset)| format!("{anchor} {offset:+.3}"));
        writeln!(text, "             {:+.3} m {}", correction.offset_m, each.collect::<Vec<_>>().join(" "))?;
    }
    let models = [
        ("not judged", Some(&learnt.unjudged)),
        ("straight", learnt.straight.as_ref()),
        ("not straight", learnt.nlos.as_ref()),
    ];
    for (name, choice) in models {
        if let Some(choice) = choice {
            writeln!(text, "{name:<12} {}", chosen(choice))?;
        }
    }
    write(&mut text, "held out, m", held_out)?;
    for test in tests {
        write(&mut text, &format!("{}, m", test.data), &test.errors)?;
    }
    Ok(text)
}

/// What was chosen, and its error over that of nothing.
fn chosen(choice: &Choice) -> String {
    let mae =
        |index: usize| choice.tried.get(index).map_or(f64::NAN, adit_tuning::ranges::choice::Tried::mae_m);
    let (with, without) = (mae(choice.index), mae(0));
    if choice.index == 0 {
        format!("{} ({without:.3} m)", choice.chosen)
    } else {
        format!("{} ({without:.3} m becomes {with:.3} m in groups held out)", choice.chosen)
    }
}

fn write(text: &mut String, heading: &str, classes: &[ClassErrors]) -> Result<()> {
    writeln!(
        text,
        "\n{heading:<28}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
        "ranges", "mean", "MAE", "RMSE", "median", "95 %"
    )?;
    for one in classes {
        let class = one.class.map_or("all", |class| class.name());
        let mut row = |name: &str, errors: &Errors| {
            let Errors { mean_m, mae_m, rmse_m, median_m, p95_m } = errors;
            let (label, ranges) = (format!("{class} {name}"), one.ranges);
            writeln!(
                text,
                "{label:<28}{ranges:>8}{mean_m:>8.3}{mae_m:>8.3}{rmse_m:>8.3}{median_m:>8.3}{p95_m:>8.3}"
            )
        };
        row("as measured", &one.raw)?;
        row("corrected", &one.corrected)?;
        if let Some(errors) = &one.class_known {
            row("corrected, class known", errors)?;
        }
        writeln!(text, "{:<28}{:>8.2}", format!("{class} error²/σ²"), one.normalised_square)?;
    }
    Ok(())
}
