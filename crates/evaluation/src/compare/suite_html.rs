//! A suite as one HTML page: the opening table, then every part.

use super::html::escape;
use super::style::STYLE;
use super::suite::{JudgedPart, Suite, SuitePart, shown};
use crate::EvaluationError;
use crate::plot::{DistributionCurve, PathCurve, error_distribution_figure, path_figure};
use std::fmt::Write;

/// What only a suite has.
const OWN_STYLE: &str = "\
body{max-width:84rem}h2{border-top:1px solid var(--line);padding-top:1rem}\
.wide{overflow-x:auto}th,td{padding:.25rem .55rem}\
table.opening{font-size:.8125rem}table.opening td,table.opening th{padding:.25rem .45rem}\
table.parts td:nth-child(2),table.parts th:nth-child(2),table.all td:nth-child(2),table.all th:nth-child(2){text-align:left;color:var(--muted)}\
table.opening th{vertical-align:bottom}table.opening th.m{writing-mode:vertical-rl;transform:rotate(180deg);text-align:left;padding:.6rem .2rem}\
table.opening td:first-child{position:sticky;left:0;background:var(--panel)}\
td.best{font-weight:600;color:var(--good);background:var(--good-ground)}td.none{color:var(--faint)}td.skipped{color:var(--muted);font-style:italic;text-align:left}\
details{margin:.4rem 0}summary{cursor:pointer}p.about{max-width:52rem}\
@media print{.wide{overflow:visible}h2{break-before:page}}";

/// The section of one part: its table, the paths of its first run, the distributions of its errors.
pub fn part_html(
    part: &SuitePart,
    paths: &[PathCurve<'_>],
    errors: &[DistributionCurve],
) -> Result<String, EvaluationError> {
    let mut page = String::new();
    // Writing to a String does not fail.
    let _ = write!(
        page,
        "<h2 id=\"{}\">{}</h2>\n<p class=\"about\">{}</p>\n",
        anchor(&part.name),
        escape(&part.name),
        escape(&part.about)
    );
    let Some(judged) = &part.judged else {
        let _ = writeln!(page, "<p><b>{}</b></p>", escape(part.skipped.as_deref().unwrap_or("not run")));
        return Ok(page);
    };
    let comparison = &judged.comparison;
    let _ = writeln!(
        page,
        "<p class=\"note\">{} run{}{}; aligned {}, judged {}.</p>",
        comparison.seeds,
        if comparison.seeds == 1 { "" } else { "s" },
        comparison.first_seed.map_or_else(String::new, |seed| format!(", seeds from {seed}")),
        escape(&comparison.alignment),
        comparison.judged(),
    );
    contenders_table(&mut page, part, judged);
    if judged.run_names.len() > 1 {
        runs_table(&mut page, part, judged);
    }
    warnings(&mut page, judged);
    if !paths.is_empty() {
        page += "<h3>Paths of the first run</h3>\n";
        page += &path_figure(paths, "")?;
    }
    if !errors.is_empty() {
        let _ = writeln!(page, "<h3>Distribution of the errors, all moments of all runs</h3>");
        page += &error_distribution_figure(errors, part.unit)?;
    }
    Ok(page)
}

fn contenders_table(page: &mut String, part: &SuitePart, judged: &JudgedPart) {
    let (unit, figure) = (part.unit, part.figure.words());
    let reference = judged.differences.first().map(|difference| difference.minus.as_str());
    let against = reference.map_or_else(String::new, |name| format!("more than {} [95 %]", escape(name)));
    let _ = writeln!(
        page,
        "<div class=\"wide\"><table class=\"parts\"><tr><th>contender</th><th>method</th><th>{figure}, {unit}: mean</th><th>median</th>\
         <th>worst run</th><th>runs</th><th>{against}</th><th>of the time</th><th>below 2 m</th><th>NEES</th><th>one sample</th></tr>"
    );
    for (name, summary) in &judged.comparison.methods {
        let Some(merit) = judged.merit_of(name) else { continue };
        let cell = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), shown);
        let best = if judged.best.contains(name) { " class=\"best\"" } else { "" };
        let difference = judged.difference_of(name).map_or_else(
            || if reference == Some(name.as_str()) { String::new() } else { "–".to_owned() },
            |d| {
                let interval = d.difference.lower.zip(d.difference.upper);
                let interval = interval
                    .map_or_else(String::new, |(low, high)| format!(" [{}, {}]", signed(low), signed(high)));
                format!("{}{interval}", signed(d.difference.mean))
            },
        );
        let nees = summary.nees.as_ref().map_or_else(|| "–".to_owned(), |nees| format!("{:.2}", nees.mean));
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{}</td><td{best}>{}</td><td>{}</td><td>{}</td><td>{} of {}</td><td>{difference}</td><td>{}</td><td>{}</td>\
             <td>{nees}</td><td>{}</td></tr>",
            escape(name),
            escape(&summary.method),
            cell(merit.mean),
            cell(merit.median),
            cell(merit.worst),
            merit.runs,
            judged.comparison.seeds,
            merit.covered_share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share)),
            summary.share_below_2m.map_or_else(|| "–".to_owned(), |share| format!("{:.1} %", 100.0 * share)),
            if summary.runs > 0 { format!("{:.0} ns", summary.time_per_step_ns) } else { "–".to_owned() },
        );
    }
    *page += "</table></div>\n";
}

fn warnings(page: &mut String, judged: &JudgedPart) {
    if judged.warnings.is_empty() {
        return;
    }
    let _ = write!(page, "<details><summary>What was odd ({})</summary><ul>", judged.warnings.len());
    for warning in &judged.warnings {
        let _ = write!(page, "<li>{}</li>", escape(warning));
    }
    *page += "</ul></details>\n";
}

/// Every contender on every run, folded in.
fn runs_table(page: &mut String, part: &SuitePart, judged: &JudgedPart) {
    let (unit, figure) = (part.unit, part.figure.words());
    let _ = write!(
        page,
        "<details><summary>Run by run: {figure}, {unit}</summary><div class=\"wide\"><table class=\"opening\"><tr><th>run</th>"
    );
    for (name, _) in &judged.merit {
        let _ = write!(page, "<th>{}</th>", escape(name));
    }
    *page += "</tr>\n";
    for (nth, run) in judged.run_names.iter().enumerate() {
        let _ = write!(page, "<tr><td>{}</td>", escape(run));
        for (_, merit) in &judged.merit {
            let value = merit.of_runs.get(nth).copied().flatten();
            let _ = write!(page, "<td>{}</td>", value.map_or_else(|| "–".to_owned(), shown));
        }
        *page += "</tr>\n";
    }
    *page += "</table></div></details>\n";
}

fn signed(value: f64) -> String {
    let text = shown(value.abs());
    format!("{}{text}", if value < 0.0 { "−" } else { "+" })
}

/// The whole page; `sections` are those of the parts, in order.
pub fn suite_html(suite: &Suite, sections: &[String]) -> String {
    let title = escape(&suite.title);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>{title}</title>\
         <style>{STYLE}{OWN_STYLE}</style></head><body>\n<h1>{title}</h1>\n<p class=\"about\">{}</p>\n",
        escape(&suite.about)
    );
    opening(&mut page, suite);
    for section in sections {
        page += section;
    }
    page += "</body></html>\n";
    page
}

fn opening(page: &mut String, suite: &Suite) {
    *page += "<div class=\"wide\"><table class=\"opening all\"><tr><th>part</th><th>figure</th><th>runs</th>";
    for method in &suite.columns {
        let _ = write!(page, "<th class=\"m\">{}</th>", escape(method));
    }
    *page += "</tr>\n";
    for part in &suite.parts {
        let (to, name) = (anchor(&part.name), escape(&part.name));
        let _ = write!(
            page,
            "<tr><td><a href=\"#{to}\">{name}</a></td><td>{}, {}</td>",
            part.figure.words(),
            part.unit
        );
        let Some(judged) = &part.judged else {
            let why = escape(part.skipped.as_deref().unwrap_or("not run"));
            let _ = writeln!(
                page,
                "<td></td><td class=\"skipped\" colspan=\"{}\">{why}</td></tr>",
                suite.columns.len()
            );
            continue;
        };
        let _ = write!(page, "<td>{}</td>", judged.comparison.seeds);
        for method in &suite.columns {
            let Some((name, merit)) = judged.of_method(method) else {
                *page += "<td class=\"none\"></td>";
                continue;
            };
            let value = merit.mean.map_or_else(|| "–".to_owned(), shown);
            let best = if judged.best.iter().any(|best| best == name) { " class=\"best\"" } else { "" };
            let mut some = if merit.runs < judged.comparison.seeds {
                format!("<br><small>{} of {}</small>", merit.runs, judged.comparison.seeds)
            } else {
                String::new()
            };
            if let Some(share) = merit.covered_share.filter(|_| !merit.is_whole()) {
                let _ = write!(some, "<br><small>{:.0} % time</small>", 100.0 * share);
            }
            let _ = write!(page, "<td{best} title=\"{}\">{value}{some}</td>", escape(name));
        }
        *page += "</tr>\n";
    }
    *page += "</table></div>\n<p class=\"note\">Mean over the runs; less is better, the best of a row is marked, all of them where several are equal. An empty field: the part does \
        not have the sensors, or the method was not entered. A small number of runs beneath: the method came to the end of so many; a dash: of none. \
        A share of the time beneath: it said so seldom where it was, errs only there, and is not marked as the best.</p>\n";
}

/// A name as the target of a link.
fn anchor(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect()
}
