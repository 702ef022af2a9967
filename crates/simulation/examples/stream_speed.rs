//! How fast one person of a full mine is simulated: `cargo run --release -p adit-simulation --example stream_speed MINE PEOPLE SECONDS`.
#![expect(clippy::unwrap_used, reason = "an example may fail by panicking")]
use adit_mine::file;
use adit_simulation::people::{PopulationSpec, VehicleSpec, Belt};
use adit_simulation::radio::delivery::{ClockSpec, LinkSpec};
use adit_simulation::radio::{RadioSpec, RangeDetail};
use adit_simulation::workforce::{Mount, Outfit, RadioRates, Workforce, WorkforceSpec};
use adit_simulation::{Emission, IdealImu, ImuErrorModel};
use std::sync::Arc;
use std::time::Instant;

fn main() {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap();
    let (mine, _) = file::open(std::path::Path::new(&path)).unwrap();
    let people: u32 = args.next().unwrap().parse().unwrap();
    let seconds: f64 = args.next().unwrap().parse().unwrap();
    let population = PopulationSpec { people, vehicles: mine.plan().vehicle_routes.iter().map(|r| VehicleSpec::on(r.id.clone())).collect(), ..PopulationSpec::default() };
    for detail in [RangeDetail::Range, RangeDetail::Diagnostics, RangeDetail::ImpulseResponse] {
    let spec = WorkforceSpec {
        duration_s: seconds,
        population: population.clone(),
        outfit: Outfit { mount: Mount::Belt(Belt::front()), ideal: IdealImu::default(), imu: ImuErrorModel::mpu6050(), imu_hz: 100.0, magnetic: None, radio: RadioRates { detail, ..RadioRates::default() } },
        radio: RadioSpec::default(),
        outages: vec![],
        conveyors_s: vec![],
        clock: ClockSpec::default(),
        link: LinkSpec::default(),
    };
    let begun = Instant::now();
    let workforce = Workforce::new(Arc::new(mine.clone()), spec, 1).unwrap();
    println!("made in {:.3} s", begun.elapsed().as_secs_f64());
    for person in [0, 7] {
        let begun = Instant::now();
        let mut counts = [0_u64; 7];
        for emission in workforce.stream(person).unwrap().unwrap() {
            counts[match emission { Emission::Imu(..) => 0, Emission::Magnetic(..) => 1, Emission::Pressure(..) => 2, Emission::Fix(..) => 3, Emission::Signal(..) => 4, Emission::Range(..) => 5, Emission::Sighting(..) => 6 }] += 1;
        }
        let took = begun.elapsed().as_secs_f64();
        println!("{detail:?} person {person}: {counts:?} in {took:.2} s, {:.0} x real time", seconds / took);
    }
    }
}
