//! `link_filter MODEL DATA…`: how long the way of a link lasts and how much a response counts (`adit_nlos::Persistence`): log loss, accuracy and calibration of a model on walks, for each pair.

use adit_nlos::examples::Examples;
use adit_nlos::judging::filtered;
use adit_nlos::measures::Measures;
use adit_nlos::{Model, Persistence};
use adit_observation::csv_log::labelled;
use std::error::Error;

const RATES_PER_S: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const WEIGHTS: [f32; 5] = [0.1, 0.2, 0.3, 0.5, 1.0];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("usage: link_filter MODEL DATA…")?;
    let model = match Model::named(&name) {
        Some(shipped) => shipped?,
        None => Model::from_bytes(&name, &std::fs::read(&name)?)?,
    };
    let sets = arguments.map(labelled::read).collect::<Result<Vec<_>, _>>()?;
    let examples = Examples::for_task(model.task, &sets);
    let classes = model.task.classes();
    println!("rate 1/s  weight  log loss  accuracy  mean F1  error of P(LOS)");
    for rate_per_s in RATES_PER_S {
        for weight in WEIGHTS {
            let told = filtered(&model, &examples, Persistence { rate_per_s, weight })
                .ok_or("ranges without times")?;
            let judged = examples.rows.iter().zip(&told).map(|(row, p)| (row.class, &p[..classes.len()]));
            let m = Measures::of(classes, judged);
            let (loss, calibration) = (m.log_loss, m.binary.calibration_error);
            println!(
                "{rate_per_s:<8}  {weight:<6}  {loss:<8.4}  {:<8.4}  {:<7.4}  {calibration:.4}",
                m.accuracy, m.macro_f1
            );
        }
    }
    Ok(())
}
