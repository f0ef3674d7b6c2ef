# Builds the C library through cargo, and installs it: shared and static library, header, pkg-config and CMake files, documents.
# docs/installing.md says how to use what is installed.
#
#   make                builds the libraries into target/lib/$(FEATURES)
#   make install        installs them; after `make` it needs no cargo, so that another user may run it
#   make uninstall      removes what `make install` with the same variables and version put there
#   make check-install  installs into target/, moves the tree, builds and runs packaging/consumers from it, and uninstalls
#   make check-cinstall  installs with cargo-c, for those who have it, compares the tree with what `make install` promises, and runs a program
#   make abi            compares symbols, structs and constants with packaging/abi; FIXPAIR_BLESS=1 records additions
#   make doxygen        the header as a manual, target/doxygen/html
#
# PREFIX, LIBDIR, INCLUDEDIR and DATADIR (the last three below PREFIX) say where things are used from, DESTDIR is put before them to stage a package.
# FEATURES are those of Cargo.toml: default, or std without linalg, or freestanding. CARGO_BUILD_TARGET builds for another machine.
# Linux and macOS; the names on macOS follow its rules, but have never been tried there.

PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DATADIR ?= $(PREFIX)/share
DESTDIR ?=
FEATURES ?= default
CARGO ?= cargo
INSTALL ?= install
CARGO_TARGET_DIR ?= target
CARGO_BUILD_TARGET ?=
# Cargo is given --target, and refuses an empty one from the environment.
unexport CARGO_BUILD_TARGET

# The version has one source, and so has the soname. Before 1.0 a minor version may break the ABI, later only a major one does.
VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
numbers := $(subst ., ,$(VERSION))
SERIES := $(if $(filter 0,$(word 1,$(numbers))),0.$(word 2,$(numbers)),$(word 1,$(numbers)))

comma := ,
space := $(subst ,, )
features := $(subst $(comma), ,$(FEATURES))
BUILD := $(CARGO_TARGET_DIR)/lib/$(if $(features),$(subst $(space),-,$(sort $(features))),none)$(CARGO_BUILD_TARGET:%=-%)
CARGO_OUT := $(CARGO_TARGET_DIR)/$(CARGO_BUILD_TARGET:%=%/)release

ifneq ($(findstring darwin,$(CARGO_BUILD_TARGET))$(if $(CARGO_BUILD_TARGET),,$(filter Darwin,$(shell uname -s))),)
SHARED := libfixpair.dylib
SONAME := libfixpair.$(SERIES).dylib
REAL := libfixpair.$(VERSION).dylib
IMPORTED_SONAME := @rpath/$(SONAME)
NAMED := -Wl,-install_name,$(IMPORTED_SONAME)
SYSTEM_LIBS := -Wl,-framework,CoreFoundation -lm
else
SHARED := libfixpair.so
SONAME := libfixpair.so.$(SERIES)
REAL := libfixpair.so.$(VERSION)
IMPORTED_SONAME := $(SONAME)
NAMED := -Wl,-soname,$(SONAME)
# What `cargo rustc ... -- --print native-static-libs` asks for, less what any C compiler links anyway.
SYSTEM_LIBS := -lpthread -ldl -lm
endif

# Features that a library lacks are hidden from its header.
with = $(filter default $(1),$(features))
DEFINES := $(strip $(if $(call with,std),,FIXPAIR_NO_THREADS) $(if $(call with,linalg),,FIXPAIR_NO_LINALG))

SOURCES := Makefile Cargo.toml Cargo.lock $(shell find src -name '*.rs')
DOCUMENTS := README.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT
PAGES := $(wildcard docs/*.md)
CMAKE_FILES := fixpair-config.cmake fixpair-config-version.cmake fixpair-targets.cmake

PKGCONFIGDIR := $(LIBDIR)/pkgconfig
CMAKEDIR := $(LIBDIR)/cmake/fixpair
DOCDIR := $(DATADIR)/doc/fixpair
FORTRANDIR := $(DATADIR)/fixpair/fortran

INSTALLED := $(addprefix $(LIBDIR)/,libfixpair.a $(REAL) $(SONAME) $(SHARED)) $(INCLUDEDIR)/fixpair.h $(PKGCONFIGDIR)/fixpair.pc \
	$(addprefix $(CMAKEDIR)/,$(CMAKE_FILES)) $(addprefix $(DOCDIR)/,$(DOCUMENTS) $(PAGES)) $(FORTRANDIR)/fixpair.f90

ifneq ($(filter-out $(PREFIX)/%,$(LIBDIR) $(INCLUDEDIR) $(DATADIR)),)
$(error LIBDIR, INCLUDEDIR and DATADIR must be below PREFIX)
endif

# Installed files find one another by relative paths, so that the tree may be moved: `up` leads from a folder to PREFIX, `below` from there.
below = $(patsubst $(PREFIX)/%,%,$(1))
up = $(subst $(space),/,$(patsubst %,..,$(subst /, ,$(call below,$(1)))))
FILL = sed -e 's|@VERSION@|$(VERSION)|' -e 's|@SERIES@|$(SERIES)|' -e 's|@REAL@|$(REAL)|' -e 's|@IMPORTED_SONAME@|$(IMPORTED_SONAME)|' \
	-e 's|@PC_UP@|$(call up,$(PKGCONFIGDIR))|' -e 's|@CMAKE_UP@|$(call up,$(CMAKEDIR))|' -e 's|@LIBDIR@|$(call below,$(LIBDIR))|' \
	-e 's|@INCLUDEDIR@|$(call below,$(INCLUDEDIR))|' -e 's|@FORTRANDIR@|$(call below,$(FORTRANDIR))|' \
	-e 's|@DEFINES@|$(addprefix -D,$(DEFINES))|' -e 's|@CMAKE_DEFINES@|$(subst $(space),;,$(DEFINES))|' \
	-e 's|@SYSTEM_LIBS@|$(SYSTEM_LIBS)|' -e 's|@CMAKE_LIBS@|$(subst $(space),;,$(SYSTEM_LIBS))|'

libraries: $(BUILD)/libfixpair.a $(BUILD)/$(SHARED)

# Both kinds at once take one optimisation of everything, not two. Copies, since cargo has one place for all features.
$(BUILD)/libfixpair.a: $(SOURCES)
	$(CARGO) rustc --locked --release --lib --crate-type staticlib,cdylib --no-default-features --features '$(features)' \
	    --target-dir $(CARGO_TARGET_DIR) $(CARGO_BUILD_TARGET:%=--target %) -- -C link-arg=$(NAMED)
	mkdir -p $(BUILD)
	cp $(CARGO_OUT)/$(SHARED) $(BUILD)/$(SHARED)
	cp $(CARGO_OUT)/libfixpair.a $@

$(BUILD)/$(SHARED): $(BUILD)/libfixpair.a ;

install: libraries
	$(INSTALL) -d $(addprefix $(DESTDIR),$(sort $(dir $(INSTALLED))))
	$(INSTALL) -m 755 $(BUILD)/$(SHARED) $(DESTDIR)$(LIBDIR)/$(REAL)
	ln -sf $(REAL) $(DESTDIR)$(LIBDIR)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(LIBDIR)/$(SHARED)
	$(INSTALL) -m 644 $(BUILD)/libfixpair.a $(DESTDIR)$(LIBDIR)
	$(INSTALL) -m 644 include/fixpair.h $(DESTDIR)$(INCLUDEDIR)
	$(FILL) packaging/fixpair.pc.in >$(DESTDIR)$(PKGCONFIGDIR)/fixpair.pc
	$(foreach file,$(CMAKE_FILES),$(FILL) packaging/$(file).in >$(DESTDIR)$(CMAKEDIR)/$(file) &&) \
	    chmod 644 $(addprefix $(DESTDIR),$(PKGCONFIGDIR)/fixpair.pc $(addprefix $(CMAKEDIR)/,$(CMAKE_FILES)))
	$(INSTALL) -m 644 $(DOCUMENTS) $(DESTDIR)$(DOCDIR)
	$(INSTALL) -m 644 $(PAGES) $(DESTDIR)$(DOCDIR)/docs
	$(INSTALL) -m 644 c-examples/fortran/fixpair.f90 $(DESTDIR)$(FORTRANDIR)

# Folders that others use too stay.
uninstall:
	rm -f $(addprefix $(DESTDIR),$(INSTALLED))
	-rmdir $(addprefix $(DESTDIR),$(CMAKEDIR) $(DOCDIR)/docs $(DOCDIR) $(FORTRANDIR) $(dir $(FORTRANDIR)))

check-install: libraries
	MAKE='$(MAKE)' LIBRARIES='$(BUILD)' packaging/check-install

check-cinstall:
	packaging/check-cinstall

abi:
	$(CARGO) test --locked --test ffi abi::

doxygen:
	mkdir -p target/doxygen
	doxygen docs/Doxyfile

.PHONY: libraries install uninstall check-install check-cinstall abi doxygen
.DELETE_ON_ERROR:
