"""Head of the audit log of tests/store/audit.rs, by the rule of docs/live/store.md and Python's hashlib alone.

Run: python3 crates/server/tests/reference/audit_chain.py > crates/server/tests/reference/audit_chain.txt
"""

import hashlib

MORNING = 1_795_327_200_000_000_000
SECOND = 1_000_000_000


def row_hash(before, number, time_ns, texts):
    parts = [b"adit audit 1\n", before, number.to_bytes(8, "big"), time_ns.to_bytes(8, "big", signed=True)]
    for text in texts:
        utf8 = text.encode()
        parts += [len(utf8).to_bytes(8, "big"), utf8]
    return hashlib.sha256(b"".join(parts)).digest()


head = bytes(32)
for number, who in enumerate(["otto", "jörg"], start=1):
    head = row_hash(head, number, MORNING + number * SECOND, [who, "tag.assign", "127.0.0.1", "done", '{"tag":"t1"}'])
print(f"2:{head.hex()}")
