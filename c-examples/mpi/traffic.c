#include "traffic.h"

#include <mpi.h>

static enum traffic current = TRAFFIC_OTHER;
static uint64_t bytes[TRAFFIC_KINDS];

enum traffic traffic_of(enum traffic kind) {
    enum traffic before = current;
    current = kind;
    return before;
}

uint64_t traffic_bytes(enum traffic kind) {
    return bytes[kind];
}

static void count(int elements, MPI_Datatype type, int to, MPI_Comm comm) {
    int size, rank;
    PMPI_Type_size(type, &size);
    PMPI_Comm_rank(comm, &rank);
    if (to != rank && to != MPI_PROC_NULL) bytes[current] += (uint64_t)elements * (uint64_t)size;
}

int MPI_Send(const void *data, int elements, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
    count(elements, type, to, comm);
    return PMPI_Send(data, elements, type, to, tag, comm);
}

int MPI_Isend(const void *data, int elements, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request *request) {
    count(elements, type, to, comm);
    return PMPI_Isend(data, elements, type, to, tag, comm, request);
}

int MPI_Sendrecv(const void *data, int elements, MPI_Datatype type, int to, int tag, void *received, int receive_elements,
                 MPI_Datatype receive_type, int from, int receive_tag, MPI_Comm comm, MPI_Status *status) {
    count(elements, type, to, comm);
    return PMPI_Sendrecv(data, elements, type, to, tag, received, receive_elements, receive_type, from, receive_tag, comm, status);
}

int MPI_Alltoall(const void *data, int elements, MPI_Datatype type, void *received, int receive_elements, MPI_Datatype receive_type,
                 MPI_Comm comm) {
    int ranks;
    PMPI_Comm_size(comm, &ranks);
    for (int rank = 0; rank < ranks; rank++) count(elements, type, rank, comm);
    return PMPI_Alltoall(data, elements, type, received, receive_elements, receive_type, comm);
}

int MPI_Alltoallv(const void *data, const int *elements, const int *places, MPI_Datatype type, void *received,
                  const int *receive_elements, const int *receive_places, MPI_Datatype receive_type, MPI_Comm comm) {
    int ranks;
    PMPI_Comm_size(comm, &ranks);
    for (int rank = 0; rank < ranks; rank++) count(elements[rank], type, rank, comm);
    return PMPI_Alltoallv(data, elements, places, type, received, receive_elements, receive_places, receive_type, comm);
}

/* What this process gives to each of the others, by whatever way it goes. */
int MPI_Allgatherv(const void *data, int elements, MPI_Datatype type, void *received, const int *receive_elements,
                   const int *receive_places, MPI_Datatype receive_type, MPI_Comm comm) {
    int ranks;
    PMPI_Comm_size(comm, &ranks);
    for (int rank = 0; rank < ranks; rank++) count(elements, type, rank, comm);
    return PMPI_Allgatherv(data, elements, type, received, receive_elements, receive_places, receive_type, comm);
}

int MPI_Gatherv(const void *data, int elements, MPI_Datatype type, void *received, const int *receive_elements,
                const int *receive_places, MPI_Datatype receive_type, int root, MPI_Comm comm) {
    count(elements, type, root, comm);
    return PMPI_Gatherv(data, elements, type, received, receive_elements, receive_places, receive_type, root, comm);
}
