//! Half an hour without infrastructure, by dead reckoning and the roadways: `cargo run -p adit-estimation --example roadway_walks [SEEDS] [MINE.toml]`.

#[path = "../tests/support/roadways.rs"]
#[expect(dead_code, reason = "tests use more of it")]
mod walks;

use adit_core::nalgebra::{Matrix2, Vector3};
use adit_core::solution::radius_95_m;
use adit_estimation::place::bank::{Bank, BankParams, Place};
use adit_estimation::place::roadways::Roadways;
use adit_mine::Mine;
use adit_mine::network::NodeId;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use walks::{Carrier, Draw, Walker, places, random_route, reckon};

struct Run {
    seed: u64,
    walked_m: f64,
    end_m: f64,
    largest_m: f64,
    inside: f64,
    wrong: f64,
    lost: f64,
    hypotheses: f64,
    jump: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let seeds: u64 = std::env::args().nth(1).map_or(Ok(50), |n| n.parse())?;
    let file = std::env::args()
        .nth(2)
        .unwrap_or(concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml").into());
    let (mine, _) = adit_mine::file::open(Path::new(&file))?;
    let roadways = Arc::new(Roadways::new(&mine));
    println!("{} pieces, {} bytes", roadways.pieces(), roadways.bytes());
    let turning = Walker::default();
    let steady = Walker { goes_on: 0.85, ..turning };
    let only = std::env::args().nth(3);
    let cases = [
        ("foot", Carrier::foot(), turning),
        ("foot, long straights", Carrier::foot(), steady),
        ("poor foot", Carrier::poor_foot(), turning),
        ("poor foot, long straights", Carrier::poor_foot(), steady),
        ("waist", Carrier::waist(), turning),
        ("waist, long straights", Carrier::waist(), steady),
        ("poor waist", Carrier::poor_waist(), turning),
        ("poor waist, long straights", Carrier::poor_waist(), steady),
    ];
    for (name, carrier, walker) in
        cases.into_iter().filter(|case| only.as_deref().is_none_or(|only| case.0 == only))
    {
        for (map, known) in [("map", Some(Arc::clone(&roadways))), ("none", None)] {
            let mut runs: Vec<Run> =
                (1..=seeds).map(|seed| run(&mine, known.clone(), &carrier, &walker, seed)).collect();
            let count = runs.len() as f64;
            let mean = |of: fn(&Run) -> f64| runs.iter().map(of).sum::<f64>() / count;
            println!(
                "{name:5} {map:4}: end {:.2} %, inside {:.1} %, wrong {:.2} %, lost {:.2} %, hypotheses {:.2}, largest jump over radius {:.2}",
                100.0 * mean(|run| run.end_m / run.walked_m),
                100.0 * mean(|run| run.inside),
                100.0 * mean(|run| run.wrong),
                100.0 * mean(|run| run.lost),
                mean(|run| run.hypotheses),
                runs.iter().map(|run| run.jump).fold(0.0, f64::max),
            );
            runs.sort_by(|a, b| (b.end_m / b.walked_m).total_cmp(&(a.end_m / a.walked_m)));
            let at = |share: f64| {
                let run = &runs[((1.0 - share) * (count - 1.0)).round() as usize];
                100.0 * run.end_m / run.walked_m
            };
            println!(
                "   end, % of way: median {:.2}, 90 % {:.2}, 95 % {:.2}, worst {:.2}",
                at(0.5),
                at(0.9),
                at(0.95),
                at(1.0)
            );
            for run in runs.iter().take(4) {
                println!(
                    "   seed {}: end {:.1} m of {:.0} m, largest {:.1} m, inside {:.1} %, wrong {:.1} %",
                    run.seed,
                    run.end_m,
                    run.walked_m,
                    run.largest_m,
                    100.0 * run.inside,
                    100.0 * run.wrong
                );
            }
        }
    }
    Ok(())
}

fn start_node(mine: &Mine, draw: &mut Draw) -> NodeId {
    let network = mine.network();
    loop {
        let node = NodeId(draw.below(network.nodes().len()) as u32);
        let open = network.edges_at(node).into_iter().filter_map(|e| network.edge(e)).all(|edge| {
            edge.walkable && mine.plan().roadways[edge.roadway].kind != adit_mine::plan::RoadwayKind::Shaft
        });
        if open {
            return node;
        }
    }
}

fn run(mine: &Mine, roadways: Option<Arc<Roadways>>, carrier: &Carrier, walker: &Walker, seed: u64) -> Run {
    let mut draw = Draw::new(seed);
    let node = start_node(mine, &mut draw);
    let route = random_route(mine, &mut draw, walker, node, 30.0 * 60.0 * walker.speed_m_s);
    let way = places(&route, walker, &mut draw);
    let reckoned = reckon(&way, walker, carrier, &mut draw);
    let params = BankParams {
        tag_height_m: carrier.tag_height_m,
        level_way: !carrier.climbs,
        ..BankParams::default()
    };
    let mut bank = Bank::new(params, roadways.clone());
    bank.start(reckoned.start.clone());
    let debug = std::env::var("TRACE").is_ok_and(|s| s == seed.to_string()) && roadways.is_some();
    let (mut walked_m, mut largest_m, mut inside, mut wrong, mut lost, mut hypotheses, mut judged) =
        (0.0, 0.0_f64, 0, 0, 0, 0, 0);
    let mut end_m = 0.0;
    let mut jump = 0.0_f64;
    let mut last: Option<(Vector3<f64>, f64, f64)> = None;
    for (index, (stretch, pair)) in reckoned.stretches.iter().zip(way.windows(2)).enumerate() {
        bank.walk(stretch);
        walked_m += (pair[1] - pair[0]).norm();
        if index % 4 != 3 {
            continue;
        }
        let estimate = bank.estimate().unwrap();
        let level: Matrix2<f64> = estimate.covariance_m2.fixed_view::<2, 2>(0, 0).into_owned();
        let radius_m = radius_95_m(&level);
        if let Some((at, radius, walked)) = last {
            let moved = (estimate.position_m - at).xy().norm() - 1.2 * (walked_m - walked);
            jump = jump.max(moved / radius);
        }
        last = Some((estimate.position_m, radius_m, walked_m));
        let truth = pair[1];
        end_m = (estimate.position_m - truth).xy().norm();
        largest_m = largest_m.max(end_m);
        judged += 1;
        inside += usize::from(end_m <= radius_m);
        lost += usize::from(estimate.lost);
        hypotheses += estimate.hypotheses;
        let right = match (estimate.place, &roadways) {
            (Place::Piece(piece), Some(roadways)) => {
                let piece = roadways.piece(piece).unwrap();
                piece.distance_m(&truth.xy()) < piece.half_width_m + 3.0 + end_m.min(10.0)
                    && (piece.floor_m(piece.on(&truth.xy()).along_m) - truth.z).abs() < 4.0
            }
            (Place::Chamber(_) | Place::Off, Some(_)) => false,
            (_, None) => true,
        };
        wrong += usize::from(!right);
        if debug && (judged % 5 == 0 || !right || bank.hypotheses().len() > 1) {
            println!(
                "{:6.0} m: error {:6.1} of {:6.1}, truth {:.0} {:.0} {:.0}, at {:.0} {:.0} {:.0} {:?} {:.2} of {} {}",
                walked_m,
                end_m,
                radius_m,
                truth.x,
                truth.y,
                truth.z,
                estimate.position_m.x,
                estimate.position_m.y,
                estimate.position_m.z,
                estimate.place,
                estimate.share,
                estimate.hypotheses,
                if estimate.lost {
                    "lost".into()
                } else {
                    bank.hypotheses()
                        .iter()
                        .map(|h| {
                            format!(
                                "{:?} {:.0} {:.0} w{:.2} f{:.2}±{:.2} t{:.0}±{:.0} s{:.1};",
                                h.place,
                                h.state.position_m.x,
                                h.state.position_m.y,
                                h.weight(),
                                h.state.factor,
                                h.state.covariance[(6, 6)].sqrt(),
                                h.state.turn_rad.to_degrees(),
                                h.state.direction_rad2().sqrt().to_degrees(),
                                h.strain
                            )
                        })
                        .collect::<String>()
                }
            );
        }
    }
    let judged = judged as f64;
    Run {
        seed,
        walked_m,
        end_m,
        largest_m,
        inside: inside as f64 / judged,
        wrong: wrong as f64 / judged,
        lost: lost as f64 / judged,
        hypotheses: hypotheses as f64 / judged,
        jump,
    }
}
