# The few commands of the repository. A fresh machine needs Rust (rustup), a C compiler, and the Rust package registry.
.PHONY: help console demo test bench results

help: ## this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-8s  %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

# The console is part of the binary where npm is there to build it; without npm the server says so on its page.
console:
	@bash ci/console.sh

demo: console ## build adit and start a simulated shift, live in the browser
	cargo run --locked --release -p adit-cli --bin adit -- demo

test: ## every check: format, lints, tests, doc tests, docs, no_std proof, repository rules
	@bash ci/test.sh

bench: ## speed: criterion benchmarks, and a rival on the same walk
	cargo bench --locked --workspace --bench '*'
	@bash ci/rival.sh

results: ## regenerate the measured figures in the docs from the recorded sets (ADIT_DATA, default ../shared/data)
	@bash ci/results.sh
