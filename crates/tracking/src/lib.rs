//! Solutions become tracks, zone entries, headcounts, alarms and evacuation state.
