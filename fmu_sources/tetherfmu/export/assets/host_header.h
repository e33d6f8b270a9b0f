/* ${file}.fmu for FMI ${fmi}.0, written by TetherFMU $version when it built that FMU; do not edit.

Value references by the names of the variables, how many values those have that are vectors, and choices of parameters. */
#ifndef $guard
#define $guard

#ifdef ${prefix}MODEL_IDENTIFIER
#error "${file}.h: another header has names with ${prefix}, too: build one of them with --header-prefix"
#endif
#define ${prefix}MODEL_IDENTIFIER $identifier
#define ${prefix}$token_name $token
#define ${prefix}FMI_VERSION ${fmi}

$body

#endif
