/* pthread.h for WebAssembly, which has one thread here: a lock is free, and no thread begins. */
#ifndef RIDDLE_WASI_PTHREAD_H
#define RIDDLE_WASI_PTHREAD_H
#include <sys/types.h> /* has the types */
#define PTHREAD_MUTEX_INITIALIZER {0}
#define pthread_mutex_lock(lock) ((void)(lock))
#define pthread_mutex_unlock(lock) ((void)(lock))
#define pthread_mutex_destroy(lock) ((void)(lock))
#define pthread_create(thread, how, work, argument) ((void)(thread), (void)(work), (void)(argument), 1)
#define pthread_join(thread, result) ((void)(thread))
#endif
