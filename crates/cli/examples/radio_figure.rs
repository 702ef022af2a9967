//! Draws how a position comes from signal strengths: three circles and their inner points on the left, the likelihood over a lattice of places
//! with the fixes of several methods on the right, of one simulated scan.
//!
//! `radio_figure OUT.svg`; `ci/results.sh` calls it.

use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_estimation::radio::centroid::{CentroidWeight, centroid};
use adit_estimation::radio::circles::{CircleParams, InnerWeight, inner_points};
use adit_estimation::radio::map::{Hearing, Storeys};
use adit_estimation::radio::path_loss::mean_dbm;
use adit_estimation::radio::signal_fit::{SignalFitParams, signal_fit};
use adit_estimation::radio::{
    AreaPrior, Emitter, Heard, Lattice, MapParams, PathLoss, RadioFix, RadioMap, Reading,
};
use anyhow::{Context, Result};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StudentT};
use std::fmt::Write as _;

const MODEL: PathLoss =
    PathLoss { rssi_at_1m_dbm: -42.0, exponent: 2.4, breakpoint_m: None, exponent_beyond: None };
const PLACES: [(f64, f64); 5] = [(3.0, 3.0), (21.0, 2.0), (12.0, 13.5), (27.0, 13.0), (1.0, 14.0)];
const TAG: (f64, f64) = (13.0, 6.5);
/// Size of a panel, m, and of a metre, pixels.
const EXTENT_M: (f64, f64) = (28.0, 16.0);
const SCALE: f64 = 14.0;
const MARGIN: f64 = 12.0;

/// A panel of the figure: metres to pixels.
struct Panel {
    left: f64,
}

impl Panel {
    fn x(&self, east_m: f64) -> f64 {
        self.left + SCALE * east_m
    }

    fn y(north_m: f64) -> f64 {
        MARGIN + 20.0 + SCALE * (EXTENT_M.1 - north_m)
    }

    fn circle(&self, svg: &mut String, centre: Vector2<f64>, radius_px: f64, style: &str) -> Result<()> {
        let (x, y) = (self.x(centre.x), Self::y(centre.y));
        Ok(writeln!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius_px:.1}" {style}/>"#)?)
    }

    fn label(&self, svg: &mut String, at: Vector2<f64>, shift: (f64, f64), text: &str) -> Result<()> {
        let (x, y) = (self.x(at.x) + shift.0, Self::y(at.y) + shift.1);
        Ok(writeln!(svg, r#"<text x="{x:.1}" y="{y:.1}">{text}</text>"#)?)
    }

    /// The ellipse that holds a normal error with 95 %.
    fn ellipse(&self, svg: &mut String, fix: &RadioFix, style: &str) -> Result<()> {
        let eigen = fix.covariance_m2.symmetric_eigen();
        // √χ²(2, 95 %).
        let axis = |k: usize| 2.4477 * SCALE * eigen.eigenvalues[k].max(0.0).sqrt();
        let along = eigen.eigenvectors.column(0);
        let turn = -along.y.atan2(along.x).to_degrees();
        let (x, y) = (self.x(fix.position_m.x), Self::y(fix.position_m.y));
        Ok(writeln!(
            svg,
            r#"<ellipse rx="{:.1}" ry="{:.1}" transform="translate({x:.1} {y:.1}) rotate({turn:.1})" {style}/>"#,
            axis(0),
            axis(1)
        )?)
    }

    /// Transmitters, the tag, and a word above.
    fn furnish(&self, svg: &mut String, clip: &str, title: &str) -> Result<()> {
        let (width, height) = (SCALE * EXTENT_M.0, SCALE * EXTENT_M.1);
        let top = Self::y(EXTENT_M.1);
        writeln!(
            svg,
            r##"</g><rect x="{:.1}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#555"/>"##,
            self.left
        )?;
        writeln!(
            svg,
            r#"<text x="{:.1}" y="{:.1}" class="title">{title}</text><g clip-path="url(#{clip})">"#,
            self.left,
            top - 8.0
        )?;
        for (index, (x, y)) in PLACES.iter().enumerate() {
            let place = Vector2::new(*x, *y);
            let (px, py) = (self.x(*x), Self::y(*y));
            writeln!(svg, r##"<path d="M{px:.1} {:.1}l6 11h-12z" fill="#333"/>"##, py - 7.0)?;
            self.label(svg, place, (9.0, 5.0), &format!("{}", index + 1))?;
        }
        let (x, y) = (self.x(TAG.0), Self::y(TAG.1));
        writeln!(
            svg,
            r##"<path d="M{:.1} {y:.1}h12M{x:.1} {:.1}v12" stroke="#c00" stroke-width="2.5"/>"##,
            x - 6.0,
            y - 6.0
        )?;
        Ok(())
    }
}

fn main() -> Result<()> {
    let out = std::env::args_os().nth(1).context("usage: radio_figure OUT.svg")?;
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let tail = StudentT::new(5.0).ok().context("five degrees of freedom")?;
    let emitters: Vec<Emitter> = PLACES
        .iter()
        .map(|(x, y)| Emitter { position_m: Vector3::new(*x, *y, 0.0), path_loss: MODEL, sigma_db: 3.0 })
        .collect();
    let tag = Vector3::new(TAG.0, TAG.1, 0.0);
    let heard: Vec<Heard<'_>> = emitters
        .iter()
        .map(|emitter| {
            let mean = mean_dbm(&MODEL, (emitter.position_m - tag).norm());
            Heard { emitter, rssi_dbm: mean + 3.0 * tail.sample(&mut random) }
        })
        .collect();
    let (width, height) = (2.0 * SCALE * EXTENT_M.0 + 4.0 * MARGIN, SCALE * EXTENT_M.1 + 2.0 * MARGIN + 46.0);
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">
<style>.title{{font-size:13px;font-weight:bold}}</style><rect width="100%" height="100%" fill="#fff"/>
"##
    );
    let panels = [Panel { left: MARGIN }, Panel { left: 3.0 * MARGIN + SCALE * EXTENT_M.0 }];
    for (panel, clip) in panels.iter().zip(["left", "right"]) {
        writeln!(
            svg,
            r#"<clipPath id="{clip}"><rect x="{:.1}" y="{:.1}" width="{}" height="{}"/></clipPath>"#,
            panel.left,
            Panel::y(EXTENT_M.1),
            SCALE * EXTENT_M.0,
            SCALE * EXTENT_M.1
        )?;
    }
    circles(&mut svg, &panels[0], &heard)?;
    likelihood(&mut svg, &panels[1], &heard)?;
    let y = height - MARGIN;
    writeln!(
        svg,
        r##"<text x="{MARGIN}" y="{y}">▲ transmitters, <tspan fill="#c00">+ the tag</tspan>. Grey: the three strongest, their circles and inner points.</text>"##
    )?;
    svg.push_str("</svg>\n");
    std::fs::write(&out, svg).with_context(|| out.to_string_lossy().into_owned())
}

/// The three strongest, their circles, the inner points, the centroid of S1.
fn circles(svg: &mut String, panel: &Panel, heard: &[Heard<'_>]) -> Result<()> {
    writeln!(svg, r#"<g clip-path="url(#left)">"#)?;
    let mut strongest = heard.to_vec();
    strongest.sort_by(|a, b| b.rssi_dbm.total_cmp(&a.rssi_dbm));
    strongest.truncate(3);
    for one in &strongest {
        let radius = SCALE * one.level_range_m(0.0);
        panel.circle(
            svg,
            one.emitter.position_m.xy(),
            radius,
            r##"fill="none" stroke="#888" stroke-width="1.3""##,
        )?;
    }
    // Each point alone: the fix of a pair weighs the third out, so two of the three are asked.
    for (name, pair) in ["D", "E", "F"].iter().zip([[0, 1, 2], [0, 2, 1], [1, 2, 0]]) {
        let [a, b, third] =
            pair.map(|k| (strongest[k].emitter.position_m.xy(), strongest[k].level_range_m(0.0)));
        let point = inner(a, b, third.0);
        panel.circle(svg, point, 4.0, r##"fill="#888""##)?;
        panel.label(svg, point, (6.0, -5.0), name)?;
    }
    let params = CircleParams { weight: InnerWeight::RangeOverStrength, ..CircleParams::default() };
    let fix = inner_points(&strongest, &params).context("three are heard")?;
    panel.circle(svg, fix.position_m, 5.0, r##"fill="#1f77b4""##)?;
    panel.label(svg, fix.position_m, (8.0, 12.0), "O, weighted as in S1")?;
    panel.furnish(svg, "left", "Three circles and their inner points")?;
    Ok(writeln!(svg, "</g>")?)
}

/// For the drawing alone: the meeting of two circles nearer to a third centre, or the point between them.
fn inner((a, ra): (Vector2<f64>, f64), (b, rb): (Vector2<f64>, f64), third: Vector2<f64>) -> Vector2<f64> {
    let (distance, towards) = ((b - a).norm(), (b - a).normalize());
    let along = 0.5 * (distance + (ra * ra - rb * rb) / distance);
    let rest = ra * ra - along * along;
    if rest < 0.0 {
        return a + towards * (0.5 * (distance + ra - rb));
    }
    let across = Vector2::new(-towards.y, towards.x) * rest.sqrt();
    let (left, right) = (a + towards * along + across, a + towards * along - across);
    if (left - third).norm() < (right - third).norm() { left } else { right }
}

/// The likelihood of all five over a lattice, and the fixes of several methods.
fn likelihood(svg: &mut String, panel: &Panel, heard: &[Heard<'_>]) -> Result<()> {
    writeln!(svg, r#"<g clip-path="url(#right)">"#)?;
    let step = 0.5;
    let lattice = Lattice::within(&Vector2::zeros(), &Vector2::new(EXTENT_M.0, EXTENT_M.1), step)
        .context("a lattice")?;
    let placed: Vec<_> = heard.iter().map(|one| (*one.emitter, None)).collect();
    let hearing = Hearing { half_dbm: -95.0, width_db: 4.0, unsure: 0.1 };
    let storeys = Storeys { height_m: 3.0, loss_db: 0.0 };
    let map = RadioMap::of_emitters(lattice, &placed, 0.0, &storeys, &hearing).context("a map")?;
    let readings: Vec<Reading> = heard
        .iter()
        .enumerate()
        .map(|(transmitter, one)| Reading { transmitter, value: one.rssi_dbm })
        .collect();
    let mut log = Vec::new();
    map.log_likelihood(&readings, &MapParams::SCAN, &mut log);
    let best = log.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for ((place, _), log) in map.lattice().iter().zip(&log) {
        let shade = (log - best).exp();
        if shade > 0.02 {
            let side = SCALE * step;
            let (x, y) = (panel.x(place.x) - 0.5 * side, Panel::y(place.y) - 0.5 * side);
            writeln!(
                svg,
                r##"<rect x="{x:.1}" y="{y:.1}" width="{side:.1}" height="{side:.1}" fill="#ff7f0e" fill-opacity="{:.2}"/>"##,
                0.75 * shade
            )?;
        }
    }
    let area = AreaPrior {
        mean_m: Vector2::new(EXTENT_M.0, EXTENT_M.1) * 0.5,
        covariance_m2: Matrix2::new(65.0, 0.0, 0.0, 21.0),
    };
    let on_map = map.fix(&readings, &MapParams::SCAN).context("a fix on the map")?.fix;
    let fixes = [
        ("centroid", centroid(heard, CentroidWeight::InverseRange), "#888", (8.0, -4.0), false),
        ("S1", inner_points(heard, &CircleParams::default()), "#1f77b4", (8.0, 12.0), false),
        (
            "robust fit",
            signal_fit(heard, Some(&area), &SignalFitParams::default()),
            "#2ca02c",
            (-66.0, -6.0),
            true,
        ),
        ("map", Some(on_map), "#d2691e", (8.0, 4.0), true),
    ];
    for (name, fix, colour, shift, with_ellipse) in fixes {
        let fix = fix.context("a fix")?;
        if with_ellipse {
            panel.ellipse(svg, &fix, &format!(r#"fill="none" stroke="{colour}" stroke-width="1.6""#))?;
        }
        panel.circle(svg, fix.position_m, 5.0, &format!(r#"fill="{colour}""#))?;
        panel.label(svg, fix.position_m, shift, name)?;
    }
    panel.furnish(svg, "right", "Likelihood over the places, fixes and 95 % ellipses")?;
    Ok(writeln!(svg, "</g>")?)
}
