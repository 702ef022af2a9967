#![expect(clippy::unwrap_used, reason = "tests")]

use super::*;

fn table(text: &str) -> Result<LabelledRanges, LogError> {
    from_inputs(Input::from_bytes("meta.csv", text.as_bytes()).unwrap(), None)
}

fn with_responses(bytes: &[u8]) -> Result<LabelledRanges, LogError> {
    let rows = Input::from_bytes("meta.csv", b"geometry_id,label\n7,LOS\n9,NDP\n").unwrap();
    from_inputs(rows, Some(Input::from_bytes("cir_i16le.bin", bytes).unwrap()))
}

#[test]
fn rows_keep_their_group_class_and_reception() {
    let set = table(
        "geometry_id,label,true_range_m,range_m,preamble_count,rx_power_dBm,pre_first_path_amplitude_std\n\
         7,LOS,2.5,2.75,274,-79.5,92.5\n9,ndp,4,,512,,80\n7,NLOS,2.5,2.8,300,-80,92\n",
    )
    .unwrap();
    assert_eq!(set.groups, ["7", "9"]);
    assert_eq!(set.ranges.iter().map(|r| r.group).collect::<Vec<_>>(), [0, 1, 0]);
    assert_eq!(
        set.ranges.iter().map(|r| r.class).collect::<Vec<_>>(),
        [LinkClass::Los, LinkClass::Ndp, LinkClass::Nlos]
    );
    assert_eq!(set.ranges[0].reception.noise_std, Some(92.5));
    assert_eq!((set.ranges[1].range_m, set.ranges[1].reception.rx_power_dbm), (None, None));
    assert!(set.tells_ndp && set.warnings.is_empty());
}

#[test]
fn a_table_of_two_classes_says_so() {
    let set = table("tag_location_id,nlos,range_m\n1,1,4.5\n1,0,3\n").unwrap();
    assert_eq!(set.ranges.iter().map(|r| r.class).collect::<Vec<_>>(), [LinkClass::Nlos, LinkClass::Los]);
    assert!(!set.tells_ndp);
}

#[test]
fn a_static_set_without_ids_is_grouped_by_height_and_distance() {
    let set =
        table("nlos,tag_height_m,true_range_m,range_m\n0,1,10,10.1\n1,1,10,10.4\n0,1.5,10,10\n0,1,11,11\n")
            .unwrap();
    assert_eq!(set.groups, ["1/10", "1.5/10", "1/11"]);
    assert_eq!(set.ranges.iter().map(|r| r.group).collect::<Vec<_>>(), [0, 0, 1, 2]);
    assert_eq!(set.ranges[1].true_range_m, Some(10.0));
}

#[test]
fn rows_keep_their_anchor() {
    let set = table("tag_location_id,anchor_id,nlos,range_m\n1,A7,1,4.5\n1,,0,3\n").unwrap();
    assert_eq!(set.ranges[0].anchor, DeviceId::new("A7"));
    assert_eq!(set.ranges[1].anchor, None);
}

#[test]
fn faults_name_file_and_line() {
    for (text, expected) in [
        (
            "geometry_id,label\n1,LOS\n1,maybe\n",
            "meta.csv:3: label: found \"maybe\", expected LOS, NLOS or NDP",
        ),
        ("geometry_id,nlos\n1,2\n", "meta.csv:2: nlos: found \"2\", expected 0 or 1"),
        (
            "geometry_id,range_m\n1,2\n",
            "meta.csv:1: missing column label or nlos; found geometry_id, range_m",
        ),
        (
            "label,range_m\nLOS,2\n",
            "meta.csv:1: missing column geometry_id or tag_location_id or room_id or group_id; found label, range_m",
        ),
        (
            "geometry_id,label,range_m\n1,LOS,-2000\n",
            "meta.csv:2: range_m: found \"-2000\", expected -1,000 to 1,000,000 m",
        ),
        (
            "geometry_id,label,rx_power_dBm\n1,LOS,90\n",
            "meta.csv:2: rx_power_dbm: found 90, expected -200 to 50 dBm",
        ),
        ("geometry_id,label\n", "meta.csv: the file ends before the first labelled range"),
    ] {
        assert_eq!(table(text).unwrap_err().to_string(), expected);
    }
}

#[test]
fn every_row_has_one_response() {
    let mut bytes = vec![0; 1600];
    bytes[800..806].copy_from_slice(&[1, 0, 0xfe, 0xff, 3, 1]);
    let set = with_responses(&bytes).unwrap();
    let response = set.ranges[1].reception.impulse_response.as_ref().unwrap();
    assert_eq!((response.first_tap, response.taps.len()), (FIRST_TAP, TAPS));
    assert_eq!(response.taps[..2], [[1, -2], [259, 0]]);
    let fault = |length: usize| with_responses(&vec![0; length]).unwrap_err().to_string();
    let expected = "expected 2 of 800 bytes, one for each row of meta.csv";
    assert_eq!(fault(800), format!("cir_i16le.bin: responses: found 1, {expected}"));
    assert_eq!(fault(2400), format!("cir_i16le.bin: responses: found more than 2, {expected}"));
    assert_eq!(fault(1000), format!("cir_i16le.bin: responses: found 1 and a part of one, {expected}"));
}
