!> Distributed linear solver: a symmetric matrix over the ranks, solved by PETSc (GAMG, hypre, MUMPS, BDDC).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The unknowns are ordered by the rank of their node, three rows to a node, so that multigrid sees blocks of displacements. Rows
!! of eliminated unknowns are those of the identity times a mean diagonal entry. Each rank passes the entries of its own rows;
!! right-hand sides and solutions are whole vectors, the same on all ranks.
!!
!! BDDC takes the matrix as a sum of parts, one of each rank's own elements, between the unknowns to which they contribute; its rows
!! are the unknowns themselves.
!! References: M. Adams, H. Bayraktar, T. Keaveny, P. Papadopoulos, SC 2004 (smoothed aggregation); V. Henson, U. Meier Yang, Appl.
!! Num. Math. 41 (2002) 155 (BoomerAMG); P. Amestoy et al., SIAM J. Matrix Anal. Appl. 23 (2001) 15 (MUMPS); J. Mandel, C. Dohrmann,
!! R. Tezaur, Appl. Num. Math. 54 (2005) 167; S. Zampini, SIAM J. Sci. Comput. 38 (2016) S282 (BDDC and its implementation).
module amontons_distributed_solver
  use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_associated, c_int, c_double
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_sparse, only: sparse_type
  use amontons_two_level_preconditioner, only: rigid_motion
  use amontons_krylov, only: krylov_options_type, krylov_report_type, KRYLOV_CONVERGED, KRYLOV_MAX_ITERATIONS
  use amontons_mpi_ranks, only: this_rank, n_ranks, gather_parts, sum_over_ranks
  implicit none
  private
  public :: distributed_solver_type, create_distributed, create_distributed_parts, update_distributed, apply_distributed, &
    solve_distributed, has_distributed_solvers
  public :: DISTRIBUTED_NONE, DISTRIBUTED_GAMG, DISTRIBUTED_HYPRE, DISTRIBUTED_MUMPS, DISTRIBUTED_TWO_LEVEL, &
    DISTRIBUTED_BDDC, DISTRIBUTED_NAMES

  integer, parameter :: DISTRIBUTED_NONE = 0
  integer, parameter :: DISTRIBUTED_GAMG = 1       !< conjugate gradients with smoothed aggregation
  integer, parameter :: DISTRIBUTED_HYPRE = 2      !< conjugate gradients with BoomerAMG, unknown by unknown
  integer, parameter :: DISTRIBUTED_MUMPS = 3      !< a multifrontal factor
  integer, parameter :: DISTRIBUTED_TWO_LEVEL = 4  !< not of PETSc: `distributed_two_level`
  integer, parameter :: DISTRIBUTED_BDDC = 5       !< conjugate gradients with balancing domain decomposition by constraints
  character(19), parameter :: DISTRIBUTED_NAMES(5) = [character(19) :: 'GAMG', 'hypre', 'MUMPS', 'two-level iteration', 'BDDC']

  real(DP), parameter :: APPLICATION_TOLERANCE = 1.0e-4_DP   !< of an application of multigrid: residual over right-hand side [-]
  integer(c_int), parameter :: MAX_APPLICATION_ITERATIONS = 100

  integer, parameter :: STATUS_DONE = 0, STATUS_BROKEN = 1   ! of distributed_shim.h

  !> The solver of one matrix. Copies are empty.
  type :: distributed_solver_type
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: kind = DISTRIBUTED_NONE
    integer, allocatable, private :: row_of(:)     !< (n) row of each unknown, from 1
    integer, allocatable, private :: counts(:)     !< (n_ranks) rows of each rank
    integer, private :: before = 0                 !< rows of the ranks before this one
    integer, private :: n_own = 0                  !< rows of this rank
    integer, allocatable, private :: source(:)     !< entry of the matrix for each entry of this rank's rows; 0: identity
    real(DP), allocatable, private :: value(:)     !< of these
  contains
    procedure, private :: copy => copy_solver
    generic :: assignment(=) => copy
    final :: release_solver
  end type distributed_solver_type

  interface
    function solver_exists() bind(C, name='amontons_solver_exists') result(is_there)
      import :: c_int
      integer(c_int) :: is_there
    end function solver_exists

    function solver_new(kind, n_rows, n_entries, row, column, motions) bind(C, name='amontons_solver_new') result(handle)
      import :: c_ptr, c_int, c_double
      integer(c_int), value :: kind, n_rows, n_entries
      integer(c_int), intent(in) :: row(*), column(*)
      real(c_double), intent(in) :: motions(*)
      type(c_ptr) :: handle
    end function solver_new

    function solver_new_parts(n_rows, n_held, held, n_entries, row, column, motions, coordinates) &
      bind(C, name='amontons_solver_new_parts') result(handle)
      import :: c_ptr, c_int, c_double
      integer(c_int), value :: n_rows, n_held, n_entries
      integer(c_int), intent(in) :: held(*), row(*), column(*)
      real(c_double), intent(in) :: motions(*), coordinates(*)
      type(c_ptr) :: handle
    end function solver_new_parts

    function solver_update(handle, value) bind(C, name='amontons_solver_update') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: value(*)
      integer(c_int) :: status
    end function solver_update

    function solver_apply(handle, b, x) bind(C, name='amontons_solver_apply') result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: b(*)
      real(c_double), intent(inout) :: x(*)
      integer(c_int) :: status
    end function solver_apply

    function solver_solve(handle, b, x, tolerance, absolute, most, iterations, residual) bind(C, name='amontons_solver_solve') &
      result(status)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: b(*)
      real(c_double), intent(inout) :: x(*)
      real(c_double), value :: tolerance, absolute
      integer(c_int), value :: most
      integer(c_int), intent(out) :: iterations
      real(c_double), intent(out) :: residual
      integer(c_int) :: status
    end function solver_solve

    subroutine solver_free(handle) bind(C, name='amontons_solver_free')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine solver_free
  end interface

contains

  !> Whether the program was built with PETSc.
  logical function has_distributed_solvers()
    has_distributed_solvers = solver_exists() /= 0
  end function has_distributed_solvers


  !> Distributes the pattern of a matrix. Errors: EXIT_SOLVER.
  subroutine create_distributed(self, kind, matrix, unknown, node_rank, coordinates, error)
    type(distributed_solver_type), intent(inout) :: self
    integer, intent(in) :: kind                    !< DISTRIBUTED_...
    type(sparse_type), intent(in) :: matrix        !< A: upper triangle
    integer, intent(in) :: unknown(:)              !< (n) of the mesh, 3 (node - 1) + axis, for each unknown of A
    integer, intent(in) :: node_rank(:)            !< (n_nodes) rank of each node, from 0
    real(DP), intent(in) :: coordinates(:, :)      !< (3, n_nodes) [length]
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: block_of(:), row(:), column(:)
    real(DP), allocatable :: motions(:, :)
    integer :: i
    call release_solver(self)
    self%kind = kind
    call number_blocks(self, unknown, node_rank, block_of)
    self%row_of = [(3 * (block_of((unknown(i) + 2) / 3) - 1) + 1 + mod(unknown(i) - 1, 3), i=1, size(unknown))]
    call list_own_entries(self, matrix, row, column)
    call find_motions_at_rows(self, unknown, coordinates, motions)
    allocate (self%value(size(self%source)))
    self%handle = solver_new(int(kind, c_int), int(self%n_own, c_int), int(size(row), c_int), &
      int(row - 1, c_int), int(column - 1, c_int), motions)
    if (.not. c_associated(self%handle)) call set_library_error(error)
  end subroutine create_distributed


  !> Distributes the pattern of a matrix that is the sum of the parts of the ranks, for BDDC. Errors: EXIT_SOLVER.
  subroutine create_distributed_parts(self, part, is_held, owner, unknown, coordinates, error)
    type(distributed_solver_type), intent(inout) :: self
    type(sparse_type), intent(in) :: part          !< A_r: upper triangle
    logical, intent(in) :: is_held(:)              !< (n) elements of this rank contribute to the unknown
    integer, intent(in) :: owner(:)                !< (n) rank of each unknown, from 0, which holds it if any does
    integer, intent(in) :: unknown(:)              !< (n) of the mesh, 3 (node - 1) + axis
    real(DP), intent(in) :: coordinates(:, :)      !< (3, n_nodes) [length]
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: held(:), row(:), column(:)
    real(DP), allocatable :: motions(:, :), n_holders(:), places(:, :)
    integer :: i, rank
    rank = this_rank()
    call release_solver(self)
    self%kind = DISTRIBUTED_BDDC
    call number_unknowns(self, owner)
    n_holders = merge(1.0_DP, 0.0_DP, is_held)
    call sum_over_ranks(n_holders)
    held = pack([(i, i=1, size(owner))], is_held .or. (n_holders < 0.5_DP .and. owner == rank))
    call list_part_entries(self, part, held, row, column)
    call find_motions_at_rows(self, unknown, coordinates, motions)
    allocate (places(3, max(1, self%n_own)), source=0.0_DP)
    do i = 1, size(owner)
      if (owner(i) == rank) places(:, self%row_of(i) - self%before) = coordinates(:, (unknown(i) + 2) / 3)
    end do
    self%handle = solver_new_parts(int(self%n_own, c_int), int(size(held), c_int), int(self%row_of(held) - 1, c_int), &
      int(size(row), c_int), int(row - 1, c_int), int(column - 1, c_int), motions, places)
    if (.not. c_associated(self%handle)) call set_library_error(error)
  end subroutine create_distributed_parts


  !> A row for each unknown, rank by rank.
  subroutine number_unknowns(self, owner)
    type(distributed_solver_type), intent(inout) :: self
    integer, intent(in) :: owner(:)                !< (n)
    integer, allocatable :: next(:)
    integer :: i, r, rank, last
    rank = this_rank()
    last = n_ranks() - 1
    self%counts = [(count(owner == r), r=0, last)]
    allocate (next(0:last))
    next(:) = [(sum(self%counts(:r)), r=0, last)]
    self%before = next(rank)
    self%n_own = self%counts(rank + 1)
    if (allocated(self%row_of)) deallocate (self%row_of)
    allocate (self%row_of(size(owner)))
    do i = 1, size(owner)
      next(owner(i)) = next(owner(i)) + 1
      self%row_of(i) = next(owner(i))
    end do
  end subroutine number_unknowns


  !> Row, column and source of the entries of a part between the unknowns that this rank holds: both triangles.
  subroutine list_part_entries(self, part, held, row, column)
    type(distributed_solver_type), intent(inout) :: self
    type(sparse_type), intent(in) :: part
    integer, intent(in) :: held(:)                 !< unknowns
    integer, allocatable, intent(out) :: row(:), column(:)   !< places in it
    integer :: place(part%n_rows), pass, n, i, j, k
    place = 0
    place(held) = [(i, i=1, size(held))]
    do pass = 1, 2
      n = 0
      do i = 1, size(held)
        do k = part%first(held(i)), part%first(held(i) + 1) - 1
          j = place(part%column(k))
          if (j == 0) cycle
          if (pass == 2) then
            row(n + 1) = i
            column(n + 1) = j
            row(n + merge(1, 2, i == j)) = j
            column(n + merge(1, 2, i == j)) = i
            self%source(n + 1:n + merge(1, 2, i == j)) = k
          end if
          n = n + merge(1, 2, i == j)
        end do
      end do
      if (pass == 2) exit
      if (allocated(self%source)) deallocate (self%source)
      if (allocated(self%value)) deallocate (self%value)
      allocate (row(n), column(n), self%source(n), self%value(n))
    end do
  end subroutine list_part_entries


  !> Numbers the nodes that have unknowns, rank by rank.
  subroutine number_blocks(self, unknown, node_rank, block_of)
    type(distributed_solver_type), intent(inout) :: self
    integer, intent(in) :: unknown(:), node_rank(:)
    integer, allocatable, intent(out) :: block_of(:)   !< (n_nodes) 0: all its unknowns are eliminated
    integer :: i, r, n
    allocate (block_of(size(node_rank)), source=0)
    block_of((unknown + 2) / 3) = 1
    if (allocated(self%counts)) deallocate (self%counts)
    allocate (self%counts(n_ranks()), source=0)
    n = 0
    do r = 0, n_ranks() - 1
      if (r == this_rank()) self%before = 3 * n
      do i = 1, size(node_rank)
        if (block_of(i) == 0 .or. node_rank(i) /= r) cycle
        n = n + 1
        block_of(i) = n
        self%counts(r + 1) = self%counts(r + 1) + 3
      end do
    end do
    self%n_own = self%counts(this_rank() + 1)
  end subroutine number_blocks


  !> Row, column and source of all entries in the rows of this rank: both triangles, and the identity of eliminated unknowns.
  subroutine list_own_entries(self, matrix, row, column)
    type(distributed_solver_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, allocatable, intent(out) :: row(:), column(:)
    logical :: is_unknown(self%before + 1:self%before + self%n_own)
    integer :: pass, n, i, k
    is_unknown = .false.
    do i = 1, matrix%n_rows
      if (is_own(self%row_of(i))) is_unknown(self%row_of(i)) = .true.
    end do
    do pass = 1, 2
      n = 0
      do i = 1, matrix%n_rows
        do k = matrix%first(i), matrix%first(i + 1) - 1
          if (is_own(self%row_of(i))) call append(self%row_of(i), self%row_of(matrix%column(k)), k)
          if (is_own(self%row_of(matrix%column(k))) .and. matrix%column(k) /= i) &
            call append(self%row_of(matrix%column(k)), self%row_of(i), k)
        end do
      end do
      do i = lbound(is_unknown, 1), ubound(is_unknown, 1)
        if (.not. is_unknown(i)) call append(i, i, 0)
      end do
      if (pass == 2) exit
      if (allocated(self%source)) deallocate (self%source)
      if (allocated(self%value)) deallocate (self%value)
      allocate (row(n), column(n), self%source(n))
    end do

  contains

    !> Whether a row is one of this rank.
    pure logical function is_own(r)
      integer, intent(in) :: r
      is_own = r > self%before .and. r <= self%before + size(is_unknown)
    end function is_own

    !> One entry more.
    subroutine append(r, c, entry)
      integer, intent(in) :: r, c, entry
      n = n + 1
      if (pass == 1) return
      row(n) = r
      column(n) = c
      self%source(n) = entry
    end subroutine append

  end subroutine list_own_entries


  !> The six rigid body motions at the rows of this rank, zero at eliminated unknowns.
  subroutine find_motions_at_rows(self, unknown, coordinates, motions)
    type(distributed_solver_type), intent(in) :: self
    integer, intent(in) :: unknown(:)
    real(DP), intent(in) :: coordinates(:, :)
    real(DP), allocatable, intent(out) :: motions(:, :)   !< (6, rows)
    real(DP) :: centre(3), extent
    integer :: i, r
    centre = 0.5_DP * (minval(coordinates, dim=2) + maxval(coordinates, dim=2))
    extent = max(maxval(maxval(coordinates, dim=2) - minval(coordinates, dim=2)), tiny(1.0_DP))
    allocate (motions(6, max(1, self%n_own)), source=0.0_DP)
    do i = 1, size(unknown)
      r = self%row_of(i) - self%before
      if (r < 1 .or. r > self%n_own) cycle
      motions(:, r) = rigid_motion(1 + mod(unknown(i) - 1, 3), (coordinates(:, (unknown(i) + 2) / 3) - centre) / extent)
    end do
  end subroutine find_motions_at_rows


  !> New values, and their preconditioner or factor.
  subroutine update_distributed(self, matrix, is_broken, error)
    type(distributed_solver_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix        !< of the pattern distributed
    logical, intent(out) :: is_broken              !< .true.: the matrix is not positive definite: no solver
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: mean_diagonal
    integer :: k, status
    mean_diagonal = sum(abs(matrix%value(matrix%first(:matrix%n_rows)))) / real(max(1, matrix%n_rows), DP)
    do k = 1, size(self%source)
      if (self%source(k) == 0) then
        self%value(k) = mean_diagonal
      else
        self%value(k) = matrix%value(self%source(k))
      end if
    end do
    status = solver_update(self%handle, self%value)
    is_broken = status == STATUS_BROKEN
    if (status /= STATUS_DONE .and. .not. is_broken) call set_library_error(error)
  end subroutine update_distributed


  !> x ~ inv(A) b: by the factor, or by conjugate gradients to a few digits. One cycle of multigrid would do for a flexible outer
  !! iteration but makes it twice as long, and its directions of contact stop at larger residuals. If PETSc fails, x = b.
  subroutine apply_distributed(self, b, x)
    type(distributed_solver_type), intent(inout) :: self
    real(DP), intent(in) :: b(:)                   !< (n)
    real(DP), intent(out) :: x(:)                  !< (n)
    real(DP), allocatable :: own(:), whole(:)
    integer(c_int) :: status, n_iterations
    real(c_double) :: residual
    call scatter(self, b, own, whole)
    if (self%kind == DISTRIBUTED_MUMPS) then
      status = solver_apply(self%handle, own, whole(self%before + 1:))
    else
      status = solver_solve(self%handle, own, whole(self%before + 1:), real(APPLICATION_TOLERANCE, c_double), 0.0_c_double, &
        MAX_APPLICATION_ITERATIONS, n_iterations, residual)
    end if
    call collect(self, whole, x)
    if (status /= STATUS_DONE .and. status /= STATUS_BROKEN) x = b
  end subroutine apply_distributed


  !> Solves A x = b by conjugate gradients, from x = 0.
  subroutine solve_distributed(self, b, x, options, report, error)
    type(distributed_solver_type), intent(inout) :: self
    real(DP), intent(in) :: b(:)                   !< (n)
    real(DP), intent(out) :: x(:)                  !< (n)
    type(krylov_options_type), intent(in) :: options
    type(krylov_report_type), intent(out) :: report
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: own(:), whole(:)
    integer(c_int) :: status, n_iterations
    real(c_double) :: residual
    call scatter(self, b, own, whole)
    status = solver_solve(self%handle, own, whole(self%before + 1:), real(options%tolerance, c_double), &
      real(options%absolute_tolerance, c_double), int(options%max_iterations, c_int), n_iterations, residual)
    call collect(self, whole, x)
    report%n_iterations = int(n_iterations)
    report%residual = real(residual, DP)
    report%status = KRYLOV_CONVERGED
    if (status == STATUS_BROKEN) report%status = KRYLOV_MAX_ITERATIONS
    if (status /= STATUS_DONE .and. status /= STATUS_BROKEN) call set_library_error(error)
  end subroutine solve_distributed


  !> This rank's rows of a vector, and space for a whole one in the order of the rows.
  subroutine scatter(self, b, own, whole)
    type(distributed_solver_type), intent(in) :: self
    real(DP), intent(in) :: b(:)
    real(DP), allocatable, intent(out) :: own(:), whole(:)
    integer :: i, r
    allocate (own(max(1, self%n_own)), whole(sum(self%counts) + 1), source=0.0_DP)
    do i = 1, size(b)
      r = self%row_of(i) - self%before
      if (r >= 1 .and. r <= self%n_own) own(r) = b(i)
    end do
  end subroutine scatter


  !> The unknowns of the rows of all ranks.
  subroutine collect(self, whole, x)
    type(distributed_solver_type), intent(in) :: self
    real(DP), intent(inout) :: whole(:)            !< in: this rank's rows
    real(DP), intent(out) :: x(:)
    call gather_parts(whole, self%counts)
    x = whole(self%row_of)
  end subroutine collect


  !> An error that PETSc reports.
  subroutine set_library_error(error)
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_SOLVER, 'PETSc could not set up or solve the distributed equations: not enough memory, most likely.')
  end subroutine set_library_error


  !> Frees the memory of PETSc.
  subroutine release_solver(self)
    type(distributed_solver_type), intent(inout) :: self
    if (c_associated(self%handle)) call solver_free(self%handle)
    self%handle = c_null_ptr
  end subroutine release_solver


  !> A copy is empty: two owners of one handle would free it twice.
  subroutine copy_solver(self, other)
    class(distributed_solver_type), intent(inout) :: self
    type(distributed_solver_type), intent(in) :: other
    if (c_associated(self%handle, other%handle)) return
    call release_solver(self)
  end subroutine copy_solver

end module amontons_distributed_solver
