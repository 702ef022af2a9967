use adit_core::nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use std::fmt;

/// How far a given rotation may be from a proper one: files carry as little as three decimals.
const TOLERANCE: f64 = 2e-3;

/// Rotation from sensor to body axes (x forward, y left, z up), proper to the last bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MountingRotation(Matrix3<f64>);

impl MountingRotation {
    /// `v_body = matrix · v_sensor`.
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.0
    }

    /// From axis names, e.g. `x-forward, y-right, z-down`: where each axis of the sensor points on the body.
    pub fn from_axes(text: &str) -> Result<Self, String> {
        let mut columns: [Option<Vector3<f64>>; 3] = [None; 3];
        for part in text.split(',').map(str::trim) {
            let (axis, direction) = part
                .split_once('-')
                .and_then(|(axis, direction)| Some((axis_index(axis)?, body_direction(direction)?)))
                .ok_or_else(|| format!("found \"{part}\", expected x, y or z, a hyphen, and forward, backward, left, right, up or down"))?;
            if columns[axis].replace(direction).is_some() {
                return Err(format!("\"{part}\" names an axis for the second time"));
            }
        }
        let [Some(x), Some(y), Some(z)] = columns else {
            return Err(format!(
                "found \"{text}\", expected all three axes, as in \"x-forward, y-left, z-up\""
            ));
        };
        let matrix = Matrix3::from_columns(&[x, y, z]);
        if matrix.determinant() < 0.5 {
            return Err(format!("the axes \"{text}\" are not a right-handed frame"));
        }
        Ok(Self(matrix))
    }

    /// The 24 rotations that lay the axes of the sensor along those of the body.
    pub fn along_axes() -> impl Iterator<Item = Self> {
        let pairs = DIRECTIONS.iter().flat_map(|x| DIRECTIONS.iter().map(move |y| (x, y)));
        pairs.filter_map(|((_, x), (_, y))| {
            let (x, y) = (Vector3::from(*x), Vector3::from(*y));
            (x.dot(&y) == 0.0).then(|| Self(Matrix3::from_columns(&[x, y, x.cross(&y)])))
        })
    }

    /// From a quaternion, scalar first.
    pub fn from_wxyz([w, x, y, z]: [f64; 4]) -> Result<Self, String> {
        let q = Quaternion::new(w, x, y, z);
        let length = q.norm();
        if (length - 1.0).abs() <= TOLERANCE {
            return Ok(Self(UnitQuaternion::from_quaternion(q).to_rotation_matrix().into_inner()));
        }
        Err(format!("found a quaternion of length {length}, expected length 1"))
    }

    /// From the rows of a matrix.
    pub fn from_rows(rows: [[f64; 3]; 3]) -> Result<Self, String> {
        let matrix = Matrix3::from_fn(|r, c| rows[r][c]);
        if let Some(bad) = matrix.iter().find(|v| !v.is_finite()) {
            return Err(format!("found {bad} in the matrix, expected finite numbers"));
        }
        let off = (matrix * matrix.transpose() - Matrix3::identity()).amax();
        if off > TOLERANCE {
            return Err(format!("found rows that are off orthonormal by {off}, expected a rotation matrix"));
        }
        if matrix.determinant() < 0.0 {
            return Err("found a reflection, expected a rotation matrix (determinant 1)".to_owned());
        }
        if matrix.iter().all(|v| [0.0, 1.0].contains(&v.abs())) {
            return Ok(Self(matrix));
        }
        let q = adit_core::attitude::from_matrix(&matrix);
        Ok(Self(q.to_rotation_matrix().into_inner()))
    }
}

/// Directions of the body with their names.
const DIRECTIONS: [(&str, [f64; 3]); 6] = [
    ("forward", [1.0, 0.0, 0.0]),
    ("backward", [-1.0, 0.0, 0.0]),
    ("left", [0.0, 1.0, 0.0]),
    ("right", [0.0, -1.0, 0.0]),
    ("up", [0.0, 0.0, 1.0]),
    ("down", [0.0, 0.0, -1.0]),
];

impl fmt::Display for MountingRotation {
    /// Axis names where the axes of the sensor lie along those of the body, else the quaternion w, x, y, z.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let along = |axis: Vector3<f64>| {
            DIRECTIONS
                .iter()
                .find(|(_, d)| axis.dot(&Vector3::from(*d)) > 1.0 - TOLERANCE)
                .map(|(name, _)| *name)
        };
        let [x, y, z] = [0, 1, 2].map(|axis| along(self.0.column(axis).into_owned()));
        if let (Some(x), Some(y), Some(z)) = (x, y, z) {
            return write!(f, "x-{x}, y-{y}, z-{z}");
        }
        let q = adit_core::attitude::from_matrix(&self.0);
        write!(f, "[{:.4}, {:.4}, {:.4}, {:.4}]", q.w, q.i, q.j, q.k)
    }
}

fn axis_index(name: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == name.trim())
}

fn body_direction(name: &str) -> Option<Vector3<f64>> {
    DIRECTIONS.iter().find(|(known, _)| *known == name.trim()).map(|(_, direction)| Vector3::from(*direction))
}

impl<'de> Deserialize<'de> for MountingRotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyRotation)
    }
}

struct AnyRotation;

#[derive(Deserialize)]
#[serde(untagged)]
enum Element {
    Number(f64),
    Row([f64; 3]),
}

impl<'de> Visitor<'de> for AnyRotation {
    type Value = MountingRotation;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("axis names, a quaternion [w, x, y, z] or a matrix of three rows")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
        MountingRotation::from_axes(text).map_err(E::custom)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
        let mut numbers = Vec::new();
        let mut rows = Vec::new();
        while let Some(element) = sequence.next_element()? {
            match element {
                Element::Number(number) => numbers.push(number),
                Element::Row(row) => rows.push(row),
            }
        }
        let rotation = match (numbers.as_slice(), rows.as_slice()) {
            ([w, x, y, z], []) => MountingRotation::from_wxyz([*w, *x, *y, *z]),
            ([], [first, second, third]) => MountingRotation::from_rows([*first, *second, *third]),
            _ => Err("expected four numbers (quaternion w, x, y, z) or three rows of three".to_owned()),
        };
        rotation.map_err(de::Error::custom)
    }
}
