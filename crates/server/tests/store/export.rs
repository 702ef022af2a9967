//! What is exported is what is stored, in each format as others read it.

use crate::common::{Site, alarm, at, event, fix, whole_track};
use crate::walk::shift;
use adit_server::export::{Export, Format, TracksQuery};
use adit_server::store::{LogQuery, Record, TrackOf};
use parquet::basic::Compression;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

async fn site() -> Site {
    let site = Site::new().await;
    let mut records: Vec<Record> = shift("t1", 5000, 1).into_iter().map(Record::Fix).collect();
    records.extend((0..3000).map(|second| Record::Fix(fix("tag, \"two\"", second, second as f64))));
    site.store.commit(1, records).await.unwrap();
    site.store.compact(at(10_000)).await.unwrap();
    let records = vec![
        Record::Fix(fix("t1", 6000, 1.0)),
        Record::Event(event("zone-entered", 1, &["anna", "z1"])),
        Record::Event(event("tick", 2, &[])),
        Record::Alarm(alarm("a1", "raised", 1, None)),
        Record::Alarm(alarm("a2", "cleared", 2, Some(3))),
    ];
    site.store.commit(2, records).await.unwrap();
    site
}

fn everybody() -> TracksQuery {
    TracksQuery { of: None, from: at(-1000), until: at(10_000) }
}

async fn tracks(site: &Site, query: TracksQuery, format: Format) -> PathBuf {
    let path = site.folder.path().join("tracks");
    let georeference = None;
    let size = Export::tracks(site.store.clone(), query, format, georeference)
        .unwrap()
        .write_file(&path)
        .await
        .unwrap();
    assert_eq!(size, std::fs::metadata(&path).unwrap().len());
    path
}

#[tokio::test]
async fn tracks_as_csv_are_the_tracks() {
    let site = site().await;
    let path = tracks(&site, everybody(), Format::Csv).await;
    let mut reader = csv::Reader::from_path(path).unwrap();
    let names: Vec<_> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(
        names,
        [
            "time_s",
            "time_utc",
            "tag",
            "person",
            "x_m",
            "y_m",
            "z_m",
            "radius_95_m",
            "quality",
            "level",
            "zone"
        ]
    );
    let mut expected = whole_track(&site.store, "t1").await;
    expected.extend(whole_track(&site.store, "tag, \"two\"").await);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!((rows.len(), expected.len()), (8001, 8001));
    for (row, fix) in rows.iter().zip(&expected) {
        assert_eq!(
            (&row[0], &row[2], &row[3]),
            (&*fix.time.to_string(), &*fix.tag, fix.person.as_deref().unwrap_or(""))
        );
        let numbers: Vec<f64> = (4..8).map(|at| row[at].parse().unwrap()).collect();
        assert_eq!(numbers, [fix.position_m[0], fix.position_m[1], fix.position_m[2], fix.radius_95_m]);
        assert_eq!(&row[10], fix.zone.as_deref().unwrap_or(""));
    }
    assert_eq!(
        (&rows[5000][0], &rows[5000][1], &rows[5000][8]),
        ("1795333200.000000000", "2026-11-22T07:40:00.000Z", "fixed")
    );
}

#[tokio::test]
async fn one_persons_track_of_a_span() {
    let site = site().await;
    let query = TracksQuery { of: Some(TrackOf::Person("p-t1".to_owned())), from: at(100), until: at(200) };
    let path = tracks(&site, query, Format::Csv).await;
    let lines = std::fs::read_to_string(path).unwrap().lines().count();
    // A stamp near a limit may lie on either side of it: the walk's clock is some ms off.
    assert!((100..=102).contains(&lines), "{lines}");
    let nobody = TracksQuery { of: Some(TrackOf::Tag("nobody".to_owned())), from: at(0), until: at(200) };
    let path = tracks(&site, nobody, Format::Csv).await;
    assert_eq!(std::fs::read_to_string(path).unwrap().lines().count(), 1);
}

#[tokio::test]
async fn geojson_lies_on_the_earth_where_the_mine_is_tied_to_it() {
    let site = Site::new().await;
    let mut at_a_point = fix("t1", 1, 4700.0);
    at_a_point.position_m = [4700.0, 2800.0, 415.2];
    site.store.commit(1, vec![Record::Fix(at_a_point)]).await.unwrap();
    let mine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines/two-level.toml");
    let (mine, _) = adit_mine::file::open(&mine).unwrap();
    let path = site.folder.path().join("tracks.geojson");
    let read = || -> Value { serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap() };
    let export = |georeference| {
        Export::tracks(site.store.clone(), everybody(), Format::GeoJson, georeference).unwrap()
    };
    export(mine.georeference()).write_file(&path).await.unwrap();
    let earth = read();
    let place: Vec<f64> =
        serde_json::from_value(earth["features"][0]["geometry"]["coordinates"].clone()).unwrap();
    // Control point k1 of that mine; its tie is good to 5 cm, which is 5e-7 degrees of latitude and 7e-7 of longitude.
    assert!(
        (place[0] - 13.329_272_849_1).abs() < 7e-7 && (place[1] - 50.917_217_461_5).abs() < 5e-7,
        "{place:?}"
    );
    assert!((place[2] - 458.2).abs() < 0.05);
    assert_eq!(earth["adit_coordinates"], "WGS-84: longitude_deg, latitude_deg, height_m");
    export(None).write_file(&path).await.unwrap();
    let grid = read();
    assert_eq!(
        grid["features"][0]["geometry"],
        json!({ "type": "Point", "coordinates": [4700.0, 2800.0, 415.2] })
    );
    assert_eq!(grid["features"][0]["properties"]["time"], "2026-11-22T06:00:01.000Z");
    assert_eq!(grid["adit_coordinates"], "mine grid: x_m, y_m, z_m");
}

#[tokio::test]
async fn events_and_alarms_in_every_format() {
    let site = site().await;
    let folder = site.folder.path();
    for format in [Format::Csv, Format::GeoJson, Format::Parquet] {
        // Pages of one row: the seams between them do not show.
        let query = LogQuery { limit: 1, ..LogQuery::default() };
        let store = || site.store.clone();
        Export::events(store(), query.clone(), format, None)
            .unwrap()
            .write_file(&folder.join("events"))
            .await
            .unwrap();
        Export::alarms(store(), query, format, None)
            .unwrap()
            .write_file(&folder.join("alarms"))
            .await
            .unwrap();
        let (events, alarms) = (folder.join("events"), folder.join("alarms"));
        match format {
            Format::Csv => {
                assert_eq!(
                    std::fs::read_to_string(events).unwrap(),
                    "time_s,time_utc,kind,subjects,body\n\
                     1795327201.000000000,2026-11-22T06:00:01.000Z,zone-entered,anna;z1,\"{\"\"kind\"\":\"\"zone-entered\"\",\"\"of\"\":[\"\"anna\"\",\"\"z1\"\"],\"\"second\"\":1}\"\n\
                     1795327202.000000000,2026-11-22T06:00:02.000Z,tick,,\"{\"\"kind\"\":\"\"tick\"\",\"\"of\"\":[],\"\"second\"\":2}\"\n"
                );
                assert_eq!(std::fs::read_to_string(alarms).unwrap().lines().count(), 3);
            }
            Format::GeoJson => {
                let alarms: Value = serde_json::from_slice(&std::fs::read(alarms).unwrap()).unwrap();
                assert_eq!(alarms["features"][0]["geometry"], Value::Null);
                assert_eq!(alarms["features"][0]["properties"]["cleared"], Value::Null);
                assert_eq!(alarms["features"][1]["properties"]["cleared"], "2026-11-22T06:00:03.000Z");
                let events: Value = serde_json::from_slice(&std::fs::read(events).unwrap()).unwrap();
                assert_eq!(events["features"][0]["properties"]["subjects"], json!(["anna", "z1"]));
            }
            Format::Parquet => {
                let rows = parquet_rows(&events);
                assert_eq!(rows[0][2].1.to_string(), "[\"anna\", \"z1\"]");
                assert_eq!(rows[1][2].1.to_string(), "[]");
                let rows = parquet_rows(&alarms);
                assert_eq!(rows[0][5], ("cleared".to_owned(), Field::Null));
                assert_ne!(rows[1][5].1, Field::Null);
            }
        }
    }
}

fn parquet_rows(path: &Path) -> Vec<Vec<(String, Field)>> {
    let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    let columns = |row: parquet::record::Row| {
        row.get_column_iter().map(|(name, field)| (name.clone(), field.clone())).collect()
    };
    reader.get_row_iter(None).unwrap().map(|row| columns(row.unwrap())).collect()
}

#[tokio::test]
async fn tracks_as_parquet_are_the_tracks_in_small_groups() {
    let site = Site::new().await;
    for (position, tag) in [(1, "t1"), (2, "t2"), (3, "t3")] {
        site.store
            .commit(position, shift(tag, 40_000, position).into_iter().map(Record::Fix).collect())
            .await
            .unwrap();
    }
    site.store.compact(at(100_000)).await.unwrap();
    let query = TracksQuery { of: None, from: at(-10), until: at(100_000) };
    let path = tracks(&site, query, Format::Parquet).await;
    println!(
        "120,000 fixes as Parquet: {:.1} bytes a fix",
        std::fs::metadata(&path).unwrap().len() as f64 / 120_000.0
    );
    let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
    let groups = reader.metadata().row_groups();
    assert_eq!(groups.iter().map(parquet::file::metadata::RowGroupMetaData::num_rows).sum::<i64>(), 120_000);
    assert!(groups.len() > 1, "one group holds everything");
    assert!(matches!(groups[0].column(0).compression(), Compression::ZSTD(_)));
    let rows = parquet_rows(&path);
    let mut expected = Vec::new();
    for tag in ["t1", "t2", "t3"] {
        expected.extend(whole_track(&site.store, tag).await);
    }
    assert_eq!(rows.len(), expected.len());
    for (row, fix) in rows.iter().zip(&expected) {
        assert_eq!(row[0].1, Field::Long(fix.time.nanos()));
        assert_eq!((&row[1].1, &row[3].1), (&Field::Str(fix.tag.clone()), &Field::Double(fix.position_m[0])));
        assert_eq!(row[9].1, fix.zone.clone().map_or(Field::Null, Field::Str));
    }
}
