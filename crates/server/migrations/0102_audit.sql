-- The audit log: each row carries the SHA-256 of itself and of the hash before (store/audit.rs).
CREATE TABLE audit (
    number INTEGER PRIMARY KEY,
    time_ns INTEGER NOT NULL,
    who TEXT NOT NULL,
    what TEXT NOT NULL,
    source TEXT NOT NULL,
    outcome TEXT NOT NULL,
    detail TEXT NOT NULL,
    hash BLOB NOT NULL
) STRICT;
CREATE INDEX audit_time ON audit (time_ns);

-- Row 1: the first row that retention left stands on this number and hash. Row 2: the newest row.
CREATE TABLE audit_end (
    id INTEGER PRIMARY KEY CHECK (id IN (1, 2)),
    number INTEGER NOT NULL,
    hash BLOB NOT NULL
) STRICT;
INSERT INTO audit_end (id, number, hash) VALUES (1, 0, zeroblob(32)), (2, 0, zeroblob(32));
