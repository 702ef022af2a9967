//! Draws how well anchors lie: the dilution of precision over the laboratory of system S4, of all anchors on the left, of those in sight on the right.
//!
//! `ranging_figure MINE.toml OUT.svg`; `ci/results.sh` calls it.

use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_estimation::ranging::dilution::{Unknowns, dilution};
use adit_mine::Mine;
use anyhow::{Context, Result, bail};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Size of a panel, m, of a cell, m, and of a metre, pixels.
const EXTENT_M: (f64, f64) = (24.0, 16.0);
const CELL_M: f64 = 0.5;
const SCALE: f64 = 15.0;
const MARGIN: f64 = 14.0;
const TOP: f64 = 30.0;
/// Height of a tag at the waist, m.
const WAIST_M: f64 = 1.0;
/// From good to bad: HDOP up to, colour.
const SHADES: [(f64, &str, &str); 6] = [
    (1.2, "#08519c", "≤ 1.2"),
    (1.5, "#3182bd", "1.5"),
    (2.0, "#6baed6", "2"),
    (3.0, "#bdd7e7", "3"),
    (6.0, "#fdd0a2", "6"),
    (f64::INFINITY, "#e6550d", "more"),
];
/// Of a place that the anchors do not determine.
const NOWHERE: &str = "#7f2704";

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [mine, out] = arguments.as_slice() else { bail!("usage: ranging_figure MINE.toml OUT.svg") };
    let (mine, _) = adit_mine::file::open(mine)?;
    let (width, height) = (SCALE * EXTENT_M.0, SCALE * EXTENT_M.1);
    let (whole, tall) = (2.0 * width + 3.0 * MARGIN, height + TOP + 44.0);
    let mut svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{whole}" height="{tall}" viewBox="0 0 {whole} {tall}" font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>
"#
    );
    panel(&mut svg, &mine, MARGIN, "HDOP, all four anchors", false)?;
    panel(&mut svg, &mine, 2.0 * MARGIN + width, "HDOP, anchors in sight at the waist", true)?;
    legend(&mut svg, TOP + height + 14.0)?;
    svg.push_str("</svg>\n");
    std::fs::write(out, svg).with_context(|| out.display().to_string())
}

/// The hall, cell by cell, with its pillars and anchors.
fn panel(svg: &mut String, mine: &Mine, left: f64, title: &str, in_sight: bool) -> Result<()> {
    let x = |east_m: f64| left + SCALE * east_m;
    let y = |north_m: f64| TOP + SCALE * (EXTENT_M.1 - north_m);
    writeln!(svg, r#"<text x="{left}" y="{:.1}" font-weight="bold">{title}</text>"#, TOP - 10.0)?;
    let side = SCALE * CELL_M;
    let mut north_m = 0.5 * CELL_M;
    while north_m < EXTENT_M.1 {
        let mut cells: Vec<(f64, f64, &str)> = Vec::new();
        let mut east_m = 0.5 * CELL_M;
        while east_m < EXTENT_M.0 {
            let colour = shade(mine, &Position::new(east_m, north_m, WAIST_M), in_sight);
            match cells.last_mut() {
                Some((_, wide, last)) if *last == colour => *wide += side,
                _ => cells.push((x(east_m) - 0.5 * side, side, colour)),
            }
            east_m += CELL_M;
        }
        for (left, wide, colour) in cells {
            let top = y(north_m) - 0.5 * side;
            writeln!(
                svg,
                r#"<rect x="{left:.1}" y="{top:.1}" width="{wide:.1}" height="{side:.1}" fill="{colour}" shape-rendering="crispEdges"/>"#
            )?;
        }
        north_m += CELL_M;
    }
    for pillar in &mine.plan().pillars {
        let corners: Vec<String> = pillar
            .outline_m
            .iter()
            .map(|[east, north]| format!("{:.1},{:.1}", x(*east), y(*north)))
            .collect();
        writeln!(svg, r##"<polygon points="{}" fill="#444" stroke="#222"/>"##, corners.join(" "))?;
    }
    for anchor in &mine.plan().anchors {
        let place = anchor.position_m.raw();
        let (px, py) = (x(place.x), y(place.y));
        let below = if place.y > 0.5 * EXTENT_M.1 { 18.0 } else { -10.0 };
        let (end, shift) = if place.x > 0.8 * EXTENT_M.0 { ("end", -8.0) } else { ("start", 8.0) };
        writeln!(
            svg,
            r##"<path d="M{px:.1} {:.1}l6 11h-12z" fill="#c00" stroke="white"/><text x="{:.1}" y="{:.1}" text-anchor="{end}" fill="#c00" stroke="white" stroke-width="3" paint-order="stroke">{}, {:.1} m up</text>"##,
            py - 6.0,
            px + shift,
            py + below,
            anchor.id,
            place.z
        )?;
    }
    let (width, height) = (SCALE * EXTENT_M.0, SCALE * EXTENT_M.1);
    Ok(writeln!(
        svg,
        r##"<rect x="{left}" y="{TOP}" width="{width}" height="{height}" fill="none" stroke="#555"/>"##
    )?)
}

fn shade(mine: &Mine, tag: &Position<adit_core::frames::MineGrid>, in_sight: bool) -> &'static str {
    let anchors: Vec<Vector3<f64>> = mine
        .plan()
        .anchors
        .iter()
        .filter(|anchor| !in_sight || mine.sight(&anchor.position_m, tag).is_clear())
        .map(|anchor| *anchor.position_m.raw())
        .collect();
    match dilution(anchors, tag.raw(), Unknowns::default()) {
        Some(found) => {
            SHADES.iter().find(|(to, ..)| found.hdop <= *to).map_or(NOWHERE, |(_, colour, _)| colour)
        }
        None => NOWHERE,
    }
}

fn legend(svg: &mut String, top: f64) -> Result<()> {
    let names = SHADES.iter().map(|(_, colour, name)| (*colour, *name));
    for (k, (colour, name)) in names.chain([(NOWHERE, "no position")]).enumerate() {
        let left = MARGIN + 86.0 * k as f64;
        writeln!(
            svg,
            r#"<rect x="{left:.1}" y="{top:.1}" width="16" height="12" fill="{colour}"/><text x="{:.1}" y="{:.1}">{name}</text>"#,
            left + 21.0,
            top + 10.5
        )?;
    }
    Ok(())
}
