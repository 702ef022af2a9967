//! Radio surveys and lists of transmitters: what is read, and what is refused with its line.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_observation::DeviceId;
use adit_observation::files::Input;
use adit_observation::survey::{self, Scan};
use common::data_set;
use proptest::prelude::*;

fn read(text: &str) -> Result<survey::Survey, String> {
    survey::from_input(Input::from_bytes("s.csv", text.as_bytes()).unwrap())
        .map_err(|error| error.to_string())
}

fn transmitters(text: &str) -> Result<Vec<survey::TransmitterPlace>, String> {
    let input = Input::from_bytes("aps.csv", text.as_bytes()).unwrap();
    survey::transmitters_from_input(input).map_err(|error| error.to_string())
}

#[test]
fn a_survey_is_read_as_it_stands() {
    let text = "x_m,y_m,floor,b_rtt_range_m,a_rssi_dBm,phone,b_rssi_dBm\n0,0.6,2,3.148,-67,9,\n-1.5,2e1,,,,9,-80.5\n";
    let found = read(text).unwrap();
    assert_eq!(found.transmitters.iter().map(DeviceId::as_str).collect::<Vec<_>>(), ["b", "a"]);
    assert_eq!(
        found.scans,
        [
            Scan {
                position_m: [0.0, 0.6],
                floor: 2,
                rssi_dbm: vec![None, Some(-67.0)],
                range_m: vec![Some(3.148), None]
            },
            Scan {
                position_m: [-1.5, 20.0],
                floor: 0,
                rssi_dbm: vec![Some(-80.5), None],
                range_m: vec![None, None]
            },
        ]
    );
    let warnings: Vec<String> = found.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["s.csv:1: ignored columns that are not known: phone"]);
}

#[test]
fn what_is_no_survey_is_told_with_its_line() {
    let cases = [
        ("", "s.csv: the file is empty"),
        ("x_m,y_m\n0,0\n", "s.csv:1: missing column <transmitter>_rssi_dBm or <transmitter>_range_m"),
        ("x_m,a_rssi_dBm\n0,-50\n", "s.csv:1: missing column y_m"),
        (
            "x_m,y_m,a_rssi_dBm,a_rssi_dbm\n0,0,-1,-1\n",
            "s.csv:1: columns a_rssi_dBm and a_rssi_dbm give the same quantity",
        ),
        ("x_m,y_m,_rssi_dBm\n0,0,-1\n", "s.csv:1: _rssi_dBm: found \"\", expected a name"),
        ("x_m,y_m,a_rssi_dBm\n", "s.csv: the file ends before the first row of the survey"),
        ("x_m,y_m,a_rssi_dBm\n0,0\n", "s.csv:2: found 2 fields, expected 3"),
        ("x_m,y_m,a_rssi_dBm\n0,,-50\n", "s.csv:2: y_m: found \"\", expected a finite number"),
        ("x_m,y_m,a_rssi_dBm\n0,0,100\n", "s.csv:2: a_rssi_dBm: found 100, expected -200 to 50"),
        ("x_m,y_m,a_rssi_dBm\n0,0,NaN\n", "s.csv:2: a_rssi_dBm: found \"NaN\""),
        ("x_m,y_m,a_range_m\n0,0,1e9\n", "s.csv:2: a_range_m: found 1000000000, expected -1000 to 1000000"),
        ("x_m,y_m,a_range_m\n1e9,0,1\n", "s.csv:2: x_m: found 1000000000"),
        ("x_m,y_m,floor,a_range_m\n0,0,1.5,1\n", "s.csv:2: floor: found 1.5, expected a whole number"),
    ];
    for (text, expected) in cases {
        let error = read(text).unwrap_err();
        assert!(error.starts_with(expected), "{text:?}: {error}");
    }
}

#[test]
fn transmitters_have_places_and_all_their_names() {
    let list = transmitters(
        "ap,x_m,y_m,floor,id_2g4,frequency_Hz,id_5g\n1,48.1,18.7,3,mac1,24e8,mac2\n2,1,2,,mac3,24e8,\n",
    )
    .unwrap();
    let shown: Vec<_> = list.iter().map(|one| (one.id.as_str(), one.position_m, one.floor)).collect();
    let (first, second) = ([48.1, 18.7, 0.0], [1.0, 2.0, 0.0]);
    assert_eq!(
        shown,
        [
            ("1", first, Some(3)),
            ("mac1", first, Some(3)),
            ("mac2", first, Some(3)),
            ("2", second, None),
            ("mac3", second, None)
        ]
    );
    let heights = transmitters("receiver,x_m,y_m,z_m\na,1,2,3.5\nb,1,2,\n").unwrap();
    let shown: Vec<_> = heights.iter().map(|one| (one.id.as_str(), one.position_m)).collect();
    assert_eq!(shown, [("a", [1.0, 2.0, 3.5]), ("b", [1.0, 2.0, 0.0])]);
    for (text, expected) in [
        ("x_m,y_m\n0,0\n", "aps.csv:1: missing column ap"),
        ("ap,x_m\na,0\n", "aps.csv:1: missing column y_m"),
        ("ap,x_m,y_m\n", "aps.csv: the file ends before the first transmitter"),
        ("ap,x_m,y_m\na,0,0\na,1,1\n", "aps.csv:3: ap: found a, expected a name that no other line has"),
        ("ap,x_m,y_m\na,0,up\n", "aps.csv:2: y_m: found \"up\""),
    ] {
        let error = transmitters(text).unwrap_err();
        assert!(error.starts_with(expected), "{text:?}: {error}");
    }
}

proptest! {
    #[test]
    fn no_text_breaks_the_readers(text in "(x_m|y_m|floor|a_rssi_dBm|ap|id_1|[0-9.eE,+-]|\n|\\PC){0,40}") {
        let _ = read(&text);
        let _ = transmitters(&text);
    }
}

#[test]
fn the_recorded_surveys_open_as_they_are() {
    let Some(corridor) = data_set("rssi-corridor") else { return };
    let office = survey::read(corridor.join("office_train.csv.gz")).unwrap();
    assert_eq!((office.transmitters.len(), office.scans.len()), (5, 4860));
    assert!(office.scans.iter().any(|scan| scan.range_m[0] == Some(2.204)));
    assert!(survey::is_survey(&corridor.join("office_train.csv.gz")).unwrap());
    assert_eq!(survey::read_transmitters(corridor.join("office_access_points.csv")).unwrap().len(), 5);
    let Some(floors) = data_set("rssi-floors") else { return };
    let train = survey::read(floors.join("cetc331_train.csv")).unwrap();
    assert_eq!((train.transmitters.len(), train.scans.len()), (52, 955));
    let places = survey::read_transmitters(floors.join("cetc331_access_points.csv")).unwrap();
    assert!(train.transmitters.iter().all(|id| places.iter().any(|place| place.id == *id)));
    let Some(tracks) = data_set("ble-tracks") else { return };
    assert!(!survey::is_survey(&tracks.join("straight_01_rssi.csv")).unwrap());
    let receivers = survey::read_transmitters(tracks.join("receivers.csv")).unwrap();
    assert_eq!((receivers[0].id.as_str(), receivers[0].position_m), ("sensor10", [7.0, 7.09, 1.22]));
}
