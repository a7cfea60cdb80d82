/* SPDX-License-Identifier: BSD-3-Clause
 * The one place that names Cellist's version; CMake and pkg-config read it from here. */
#ifndef CELLIST_VERSION_H
#define CELLIST_VERSION_H

#define CELLIST_VERSION_MAJOR 0
#define CELLIST_VERSION_MINOR 1
#define CELLIST_VERSION_PATCH 0
#define CELLIST_VERSION_STRING "0.1.0"

#endif
