//! What the pages look like: the console's tokens (web/src/styles/tokens.css), light or dark as the viewer has it.

/// Colours and type of both pages; the rest stands with each.
pub const STYLE: &str = "\
:root{color-scheme:light dark;--ground:#e9edf0;--panel:#ffffff;--raised:#f3f6f8;--line:#d5dde4;--text:#14202a;--muted:#4b5c6a;--faint:#a6b5c1;\
--accent:#00609f;--good:#00654a;--good-ground:#d9f2e8}\
@media (prefers-color-scheme:dark){:root{--ground:#0b1014;--panel:#121a21;--raised:#1a242d;--line:#26333e;--text:#e6edf3;--muted:#9db0bf;--faint:#3d4f5e;\
--accent:#6cc0ff;--good:#3fd0a0;--good-ground:#0c2e25}}\
body{font:0.9375rem/1.5 system-ui,-apple-system,\"Segoe UI\",\"Noto Sans\",\"PingFang SC\",\"Microsoft YaHei\",sans-serif;color:var(--text);background:var(--ground);\
margin:0 auto;padding:1.5rem 1rem 3rem}\
h1{font-size:1.5rem;line-height:1.25;margin:.5rem 0}h2{font-size:1.125rem;margin:2.5rem 0 .5rem}h3{font-size:.9375rem;margin:1.2rem 0 .2rem}\
a,summary{color:var(--accent);text-decoration:none}a:hover,a:focus-visible{text-decoration:underline}\
table{display:block;width:max-content;max-width:100%;overflow-x:auto;border-collapse:collapse;margin:.5rem 0;background:var(--panel);border:1px solid var(--line);border-radius:.5rem}\
th,td{padding:.3rem .7rem;text-align:right;border-bottom:1px solid var(--line);font-variant-numeric:tabular-nums;white-space:nowrap}\
tr:last-child td{border-bottom:0}th{color:var(--muted);font-weight:600;font-size:.8125rem}\
th:first-child,td:first-child{text-align:left}\
svg{max-width:100%;height:auto;display:block;box-sizing:border-box;background:var(--panel);border:1px solid var(--line);border-radius:.5rem}\
p.note{color:var(--muted);max-width:52rem}small{color:var(--muted)}";
