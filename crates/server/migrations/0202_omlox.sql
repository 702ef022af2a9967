-- Objects of the omlox interface, as clients gave them; unknown members are kept.
CREATE TABLE omlox_objects (
    collection TEXT NOT NULL CHECK (collection IN ('zones', 'trackables', 'providers', 'fences')),
    id         TEXT NOT NULL,
    body       TEXT NOT NULL,
    PRIMARY KEY (collection, id)
) STRICT, WITHOUT ROWID;
