//! Tracks, events and alarms as files for other programs: CSV, GeoJSON, Parquet.
