# Thin wrappers: the packages, CMake's presets, and `wobble play`.
FOR ?= 0

.PHONY: play test format packages
play:
	@sh docker/packages.sh server
	@cmake --preset release --log-level=WARNING
	@cmake --build --preset release --target programs
	@build/release/bin/wobble play --for $(FOR)

test:
	@sh docker/packages.sh server test
	@cmake --workflow --preset asan
	@cmake --workflow --preset release

format:
	@sh docker/packages.sh server test
	@cmake --preset dev --log-level=WARNING
	@cmake --build --preset dev --target format
