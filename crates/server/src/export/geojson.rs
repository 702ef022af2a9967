//! Rows as features (RFC 7946), one to a line.

use crate::export::columns::{Cell, utc};
use crate::export::pages::Exported;
use adit_core::frames::{MineGrid, Position};
use adit_mine::Georeference;
use serde_json::{Map, Value, json};

/// Decimals of degrees: 1 mm on the Earth.
const DEGREES: f64 = 1e8;
const MILLIMETRES: f64 = 1e3;

/// A feature collection under way.
pub(crate) struct Collection {
    georeference: Option<Georeference>,
    empty: bool,
}

impl Collection {
    pub(crate) const fn new(georeference: Option<Georeference>) -> Self {
        Self { georeference, empty: true }
    }

    pub(crate) fn begin(&self) -> Vec<u8> {
        let coordinates = match self.georeference {
            Some(_) => "WGS-84: longitude_deg, latitude_deg, height_m",
            None => "mine grid: x_m, y_m, z_m",
        };
        format!("{{\"type\":\"FeatureCollection\",\"adit_coordinates\":\"{coordinates}\",\"features\":[\n")
            .into_bytes()
    }

    pub(crate) fn add<T: Exported>(&mut self, rows: &[T]) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        for row in rows {
            if !std::mem::replace(&mut self.empty, false) {
                bytes.extend_from_slice(b",\n");
            }
            let coordinates = row.place().and_then(|place| self.coordinates(place));
            let geometry =
                coordinates.map_or(Value::Null, |at| json!({ "type": "Point", "coordinates": at }));
            let feature = json!({ "type": "Feature", "geometry": geometry, "properties": properties(row) });
            serde_json::to_writer(&mut bytes, &feature).map_err(|error| error.to_string())?;
        }
        Ok(bytes)
    }

    pub(crate) fn end() -> Vec<u8> {
        b"\n]}\n".to_vec()
    }

    fn coordinates(&self, place: [f64; 3]) -> Option<[f64; 3]> {
        let Some(georeference) = &self.georeference else { return Some(place) };
        let [x, y, z] = place;
        let there = georeference.to_geodetic(&Position::<MineGrid>::new(x, y, z))?;
        let rounded = |value: f64, steps: f64| (value * steps).round() / steps;
        Some([
            rounded(there.longitude_rad.to_degrees(), DEGREES),
            rounded(there.latitude_rad.to_degrees(), DEGREES),
            rounded(there.height_m, MILLIMETRES),
        ])
    }
}

fn properties<T: Exported>(row: &T) -> Map<String, Value> {
    let mut properties = Map::new();
    for column in T::COLUMNS {
        let value = match &column.cell {
            Cell::Time(of) => json!(utc(of(row))),
            Cell::OptionalTime(of) => json!(of(row).map(utc)),
            Cell::Number(of) => json!(of(row)),
            Cell::Text(of) => json!(of(row)),
            Cell::OptionalText(of) => json!(of(row)),
            Cell::Texts(of) => json!(of(row)),
            Cell::Json(of) => of(row).clone(),
        };
        properties.insert(column.name.to_owned(), value);
    }
    properties
}
