//! Vehicles: closed-form runs between stops.

use crate::common::two_level;
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_simulation::people::{Population, PopulationSpec, VehicleSpec};

fn spec() -> PopulationSpec {
    let vehicle = VehicleSpec { first_s: Some(0.0), stops: 4, ..VehicleSpec::on("ore") };
    PopulationSpec { vehicles: vec![vehicle, VehicleSpec::on("ore")], ..PopulationSpec::default() }
}

#[test]
fn a_vehicle_keeps_its_timetable_and_speed() {
    let population = Population::new(&two_level(), &spec(), 1).unwrap();
    let vehicle = &population.vehicles()[0];
    let mut fastest = (0.0_f64, 0.0_f64);
    let h = 0.05;
    let mut t = 0.0;
    while t < 1.5 * vehicle.round_s() {
        let [a, b, c] = [-h, 0.0, h].map(|dt| vehicle.pose(t + dt));
        let velocity = (c.floor_m - a.floor_m) / (2.0 * h);
        let acceleration = (c.speed_m_s - a.speed_m_s) / (2.0 * h);
        fastest = (fastest.0.max(b.speed_m_s.abs()), fastest.1.max(acceleration.abs()));
        // It goes where it points, forwards or backwards; in corners slower than along the points of its way.
        let forward = Vector3::new(b.yaw_rad.cos(), b.yaw_rad.sin(), 0.0);
        let gone = velocity.xy().norm();
        assert!(gone <= b.speed_m_s.abs() + 0.01, "at {t}");
        if b.speed_m_s.abs() > 0.5 {
            let along = velocity.xy().dot(&forward.xy()) * b.speed_m_s.signum();
            assert!(along > 0.995 * gone, "at {t}: {along} of {gone}");
        }
        t += 0.37;
    }
    // 4 m/s is the route's speed; 0.8 m/s² the strongest acceleration asked for, met in the middle of each ramp.
    assert!((fastest.0 - 4.0).abs() < 1e-9, "{fastest:?}");
    assert!((0.78..=0.8001).contains(&fastest.1), "{fastest:?}");
}

#[test]
fn at_a_stop_it_stands_where_and_when_it_says() {
    let population = Population::new(&two_level(), &spec(), 1).unwrap();
    for vehicle in population.vehicles() {
        for stop in 0..vehicle.stops() {
            let dwell = vehicle.next_dwell(stop, 3000.0, 10.0).unwrap();
            assert!(dwell.depart_s >= 3010.0 && dwell.depart_s == dwell.arrive_s + vehicle.spec().dwell_s);
            assert!(dwell.arrive_s < 3000.0 + vehicle.round_s());
            for t in [dwell.arrive_s + 1e-6, dwell.depart_s - 1e-6] {
                let pose = vehicle.pose(t);
                // Rounding over a round of 45 min at 4 m/s.
                assert!((pose.floor_m - vehicle.stop_m(stop)).norm() < 1e-5);
                assert!(pose.speed_m_s.abs() < 1e-9);
            }
            assert!(vehicle.pose(dwell.depart_s + 5.0).speed_m_s.abs() > 0.1);
            assert!(vehicle.pose(dwell.arrive_s - 5.0).speed_m_s.abs() > 0.1);
        }
    }
}

#[test]
fn its_middle_stays_in_the_air() {
    let mine = two_level();
    let population = Population::new(&mine, &spec(), 1).unwrap();
    let vehicle = &population.vehicles()[1];
    let mut t = 0.0;
    while t < vehicle.round_s() {
        let at = vehicle.pose(t).floor_m + Vector3::z();
        assert!(mine.excavation().contains(&Position::from_raw(at)), "at {t}: {at:?}");
        t += 0.5;
    }
}
