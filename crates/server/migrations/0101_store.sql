-- What the store holds of a mine's life. docs/live/store.md tells tables, units and why.
-- Times: *_ns nanoseconds, *_ms milliseconds since the Unix epoch. Lengths: cm. Names are numbers of table name.

-- 'adit' in ASCII: a file of another program is told by it.
PRAGMA application_id = 1633970548;

CREATE TABLE name (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE
) STRICT;

-- One row: the position of the journal up to which everything is in this file.
CREATE TABLE applied (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    position INTEGER NOT NULL
) STRICT;
INSERT INTO applied (id, position) VALUES (1, 0);

-- Fixes of the last minutes, in order of arrival, until they are packed.
CREATE TABLE fix_recent (
    seq INTEGER PRIMARY KEY,
    time_ms INTEGER NOT NULL,
    tag INTEGER NOT NULL,
    person INTEGER NOT NULL,
    x_cm INTEGER NOT NULL,
    y_cm INTEGER NOT NULL,
    z_cm INTEGER NOT NULL,
    radius_cm INTEGER NOT NULL,
    quality INTEGER NOT NULL,
    level INTEGER NOT NULL,
    zone INTEGER NOT NULL
) STRICT;
CREATE INDEX fix_recent_time ON fix_recent (time_ms);

-- Tags that ever had a fix.
CREATE TABLE track_tag (
    tag INTEGER PRIMARY KEY REFERENCES name (id)
) STRICT;

-- Packed fixes of one tag on one person; the chunks of a tag do not overlap in time.
CREATE TABLE track_chunk (
    id INTEGER PRIMARY KEY,
    tag INTEGER NOT NULL REFERENCES name (id),
    person INTEGER NOT NULL,
    from_ms INTEGER NOT NULL,
    until_ms INTEGER NOT NULL,
    count INTEGER NOT NULL,
    whole INTEGER NOT NULL,
    columns BLOB NOT NULL
) STRICT;
CREATE INDEX track_chunk_tag ON track_chunk (tag, from_ms, until_ms);
CREATE INDEX track_chunk_person ON track_chunk (person, tag, from_ms, until_ms);
CREATE INDEX track_chunk_until ON track_chunk (until_ms);
CREATE INDEX track_chunk_part ON track_chunk (tag, count) WHERE whole = 0;

CREATE TABLE event (
    id INTEGER PRIMARY KEY,
    time_ns INTEGER NOT NULL,
    kind INTEGER NOT NULL REFERENCES name (id),
    body TEXT NOT NULL
) STRICT;
CREATE INDEX event_time ON event (time_ns, id);
CREATE INDEX event_kind ON event (kind, time_ns, id);

CREATE TABLE event_subject (
    subject INTEGER NOT NULL REFERENCES name (id),
    time_ns INTEGER NOT NULL,
    event INTEGER NOT NULL,
    place INTEGER NOT NULL,
    PRIMARY KEY (subject, time_ns, event)
) STRICT, WITHOUT ROWID;
CREATE INDEX event_subject_event ON event_subject (event);

CREATE TABLE alarm (
    id INTEGER PRIMARY KEY,
    alarm TEXT NOT NULL UNIQUE,
    kind INTEGER NOT NULL REFERENCES name (id),
    state INTEGER NOT NULL REFERENCES name (id),
    raised_ns INTEGER NOT NULL,
    changed_ns INTEGER NOT NULL,
    cleared_ns INTEGER,
    body TEXT NOT NULL
) STRICT;
CREATE INDEX alarm_raised ON alarm (raised_ns, id);
CREATE INDEX alarm_cleared ON alarm (cleared_ns);

CREATE TABLE alarm_subject (
    subject INTEGER NOT NULL REFERENCES name (id),
    alarm INTEGER NOT NULL,
    place INTEGER NOT NULL,
    PRIMARY KEY (subject, alarm)
) STRICT, WITHOUT ROWID;
CREATE INDEX alarm_subject_alarm ON alarm_subject (alarm);
