!> Sprung: the interface where all contact is by springs: inv(T) in single precision, and GMRES in double around it.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "Contact unknowns last". The change of the contact forces is a product of thin matrices,
!!
!!     dF_c = (B A + M X) du,
!!
!! three columns a spring in B A (what spreads a change of its force over its nodes, and that change), two in M X (how its force
!! moves over the nodes with its place on the master). The tangent of the interface, J_c = S - B A - M X, is solved by GMRES. The
!! preconditioner is the formula of Sherman, Morrison and Woodbury for S - B A (Golub and Van Loan, Matrix Computations, 4th ed.,
!! section 2.1.4),
!!
!!     inv(S - B A) = inv(S) + inv(S) B inv(T) A inv(S),      T = 1 - A inv(S) B,
!!
!! in single precision, S scaled by its largest diagonal entry s, A likewise.
module amontons_woodbury_interface
  use amontons_kinds, only: DP, SP, WP => SP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_sparse, only: sparse_type, transpose_of, multiply
  use amontons_blas, only: getrf => sgetrf, laswp => slaswp, trsm => strsm, gemm => sgemm, getrs => sgetrs, &
    potrf => spotrf, potri => spotri, gemv => sgemv
  use amontons_dense, only: triangle_times, DENSE_OK, DENSE_SINGULAR, WORTH_THREADS, BLOCK
  use amontons_krylov, only: operator_type, krylov_options_type, krylov_report_type, gmres
  implicit none
  private
  public :: sprung_type, springs_type, invert_stiffness, couple_springs, solve_springs

  real(SP), parameter :: WELL_HELD = 1.0e-4_SP     !< least pivot of S over its diagonal of which an inverse is made [-]
  real(SP), parameter :: STIFF = 1.0e4_SP          !< largest entry of T: stiffer springs want more digits [-]
  integer, parameter :: LANES = 32                 !< rows of T that are made side by side
  integer, parameter :: HALF = LANES / 2
  integer, parameter :: TILE = 64                  !< unknowns of the interface that are taken over to them at a time
  integer, parameter :: MOST_ITERATIONS = 60       !< of a solution; what is left then is left to the one who asked

  !> The springs of the present contact, on the interface.
  type :: springs_type
    type(sparse_type) :: spread                    !< B (n_contact x n_springs) [-]
    type(sparse_type) :: follow                    !< A (n_springs x n_contact) [force/length]
    type(sparse_type) :: moved                     !< M (n_contact x n_moving) [force]
    type(sparse_type) :: moving                    !< X (n_moving x n_contact) [1/length]
  end type springs_type

  !> What the preconditioner is made of.
  type :: sprung_type
    logical :: is_inverse = .false.                !< compliance is that of the present bulk
    type(springs_type) :: springs
    real(DP), private :: scale = 1                 !< s [force/length]
    real(SP), allocatable, private :: compliance(:, :)   !< inv(S / s) (n_contact, n_contact) [-]
    real(SP), allocatable, private :: response(:, :)     !< R = (A inv(S))' (n_contact, n_springs) [-]
    real(SP), allocatable, private :: lu(:, :)     !< T factorised
    integer, allocatable, private :: pivots(:)
  end type sprung_type

  !> J_c as an operator.
  type, extends(operator_type) :: stiffness_type
    real(DP), pointer, contiguous :: triangle(:, :) => null()  !< L_cc
    real(DP), pointer :: shift(:) => null()        !< D
    type(springs_type), pointer :: springs => null()
  contains
    procedure :: apply => apply_stiffness
  end type stiffness_type

  !> Its approximate inverse.
  type, extends(operator_type) :: compliance_type
    type(sprung_type), pointer :: sprung => null()
  contains
    procedure :: apply => apply_compliance
  end type compliance_type

contains

  !> inv(S) for a new factor of the bulk, S = L L' - D. After: is_inverse, unless a body is held so weakly that there is none.
  subroutine invert_stiffness(self, triangle, shift, error)
    type(sprung_type), intent(inout) :: self
    real(DP), intent(in) :: triangle(:, :)         !< L (n_contact, n_contact), zero above the diagonal
    real(DP), intent(in) :: shift(:)               !< D (n_contact) [force/length]
    type(error_type), allocatable, intent(out) :: error
    real(SP), allocatable :: single(:, :)
    real(DP), allocatable :: diagonal(:)           ! of S [force/length]
    real(DP) :: root
    integer :: i, n, no_memory, status
    n = size(shift)
    self%is_inverse = .false.
    if (allocated(self%compliance)) deallocate (self%compliance)
    allocate (self%compliance(n, n), stat=no_memory)
    if (no_memory == 0) allocate (single(n, n), stat=no_memory)
    call judge_memory(no_memory, error)
    if (allocated(error)) return
    allocate (diagonal(n))
    diagonal = -shift
    do i = 1, n
      diagonal(i:) = diagonal(i:) + triangle(i:, i)**2
    end do
    self%scale = maxval(diagonal)
    if (.not. self%scale > 0.0_DP) return
    root = sqrt(self%scale)
    single = real(triangle / root, SP)
    call square_of_triangle(single, self%compliance)
    do i = 1, n
      self%compliance(i, i) = self%compliance(i, i) - real(shift(i) / self%scale, SP)
    end do
    deallocate (single)
    call invert_positive(self%compliance, WELL_HELD, status)
    self%is_inverse = status == DENSE_OK
  end subroutine invert_stiffness


  !> T for the present springs, and its factor. After: is_fit is .false. if single precision is not enough for it.
  subroutine couple_springs(self, springs, is_fit, error)
    type(sprung_type), intent(inout) :: self       !< with inv(S)
    type(springs_type), intent(in) :: springs
    logical, intent(out) :: is_fit
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: spread_t
    integer :: status
    self%springs = springs
    is_fit = .false.
    call make_room(self, springs%follow%n_rows, error)
    if (allocated(error)) return
    spread_t = transpose_of(springs%spread)
    call fill_coupling(self, spread_t)
    if (.not. maxval(abs(self%lu)) < STIFF) return
    call factorise_dense(self%lu, self%pivots, status)
    is_fit = status == DENSE_OK
  end subroutine couple_springs


  !> Room for R and T.
  subroutine make_room(self, n, error)
    type(sprung_type), intent(inout) :: self
    integer, intent(in) :: n                       !< springs
    type(error_type), allocatable, intent(out) :: error
    integer :: no_memory
    if (allocated(self%lu)) then
      if (size(self%lu, 1) == n .and. size(self%response, 1) == size(self%compliance, 1)) return
      deallocate (self%lu, self%response, self%pivots)
    end if
    allocate (self%pivots(n))
    allocate (self%lu(n, n), stat=no_memory)
    if (no_memory == 0) allocate (self%response(size(self%compliance, 1), n), stat=no_memory)
    call judge_memory(no_memory, error)
  end subroutine make_room


  !> Errors: EXIT_SOLVER if there was no room.
  subroutine judge_memory(no_memory, error)
    integer, intent(in) :: no_memory               !< status of an allocation
    type(error_type), allocatable, intent(inout) :: error
    if (no_memory /= 0) call set_error(error, EXIT_SOLVER, 'Not enough memory for the interface of contact.')
  end subroutine judge_memory


  !> R = (A inv(S))' and T = 1 - A inv(S) B. Threads share the springs; a column of R is taken once, and so many of them stand side
  !> by side for the products with B.
  subroutine fill_coupling(self, spread_t)
    type(sprung_type), intent(inout) :: self
    type(sparse_type), intent(in) :: spread_t      !< B' (n_springs x n_contact)
    real(SP), allocatable :: rows(:, :)
    integer :: n, j, last
    n = size(self%lu, 1)
    !$omp parallel private(rows, last)
    allocate (rows(LANES, size(self%compliance, 1)), source=0.0_SP)
    !$omp do schedule(static)
    do j = 1, n, LANES
      last = min(j + LANES - 1, n)
      call respond(self%springs%follow, self%scale, self%compliance, j, last, self%response)
      call take_rows(self%response, j, last, rows)
      call couple_rows(spread_t, j, last, rows, self%lu)
    end do
    !$omp end do
    deallocate (rows)
    !$omp end parallel
  end subroutine fill_coupling


  !> The columns from j to last of R.
  subroutine respond(follow, scale, compliance, j, last, response)
    type(sparse_type), intent(in) :: follow        !< A (n_springs x n_contact) [force/length]
    real(DP), intent(in) :: scale                  !< s [force/length]
    real(SP), contiguous, intent(in) :: compliance(:, :)   !< inv(S / s)
    integer, intent(in) :: j, last
    real(SP), contiguous, intent(inout) :: response(:, :)   !< R (n_contact x n_springs)
    integer :: i, p
    logical :: is_node
    i = j
    do while (i <= last)
      is_node = i + 2 <= last
      if (is_node) is_node = has_same_columns(follow, i)
      if (is_node) then
        call respond_to_node(follow, scale, compliance, i, response(:, i), response(:, i + 1), response(:, i + 2))
        i = i + 3
        cycle
      end if
      response(:, i) = 0.0_SP
      do p = follow%first(i), follow%first(i + 1) - 1
        response(:, i) = response(:, i) + real(follow%value(p) / scale, SP) * compliance(:, follow%column(p))
      end do
      i = i + 1
    end do
  end subroutine respond


  !> The same columns as rows side by side, tile by tile: so many that they are still in the cache when the next column comes.
  pure subroutine take_rows(response, j, last, rows)
    real(SP), contiguous, intent(in) :: response(:, :)
    integer, intent(in) :: j, last
    real(SP), intent(inout) :: rows(LANES, size(response, 1))
    integer :: i, k, p
    do k = 1, size(response, 1), TILE
      do p = j, last
        do i = k, min(k + TILE - 1, size(response, 1))
          rows(p - j + 1, i) = response(i, p)
        end do
      end do
    end do
  end subroutine take_rows


  !> Whether three rows, those of the springs of one node, have their entries in the same columns.
  pure logical function has_same_columns(matrix, i) result(is_same)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: i
    integer :: n
    associate (first => matrix%first, column => matrix%column)
      n = first(i + 1) - first(i)
      is_same = first(i + 2) - first(i + 1) == n .and. first(i + 3) - first(i + 2) == n
      if (is_same) is_same = all(column(first(i):first(i) + n - 1) == column(first(i + 1):first(i + 1) + n - 1)) .and. &
        all(column(first(i):first(i) + n - 1) == column(first(i + 2):first(i + 2) + n - 1))
    end associate
  end function has_same_columns


  !> Three columns of R, of springs that follow the same unknowns: four columns of inv(S) at a time, each read once.
  pure subroutine respond_to_node(follow, scale, compliance, i, x, y, z)
    type(sparse_type), intent(in) :: follow
    real(DP), intent(in) :: scale                  !< [force/length]
    real(SP), contiguous, intent(in) :: compliance(:, :)
    integer, intent(in) :: i                       !< first of the three
    real(SP), contiguous, intent(out) :: x(:), y(:), z(:)
    real(SP) :: w(4, 3)
    integer :: c(4), n, p, k
    x = 0.0_SP
    y = 0.0_SP
    z = 0.0_SP
    n = follow%first(i + 1) - follow%first(i)
    do p = 0, n - 1, 4
      w = 0.0_SP
      c = follow%column(follow%first(i))           ! a column with weight zero where less than four are left
      do k = 1, min(4, n - p)
        c(k) = follow%column(follow%first(i) + p + k - 1)
        w(k, :) = real(follow%value(follow%first(i:i + 2) + p + k - 1) / scale, SP)
      end do
      associate (a => compliance(:, c(1)), b => compliance(:, c(2)), d => compliance(:, c(3)), e => compliance(:, c(4)))
        do k = 1, size(x)
          x(k) = x(k) + (w(1, 1) * a(k) + w(2, 1) * b(k)) + (w(3, 1) * d(k) + w(4, 1) * e(k))
          y(k) = y(k) + (w(1, 2) * a(k) + w(2, 2) * b(k)) + (w(3, 2) * d(k) + w(4, 2) * e(k))
          z(k) = z(k) + (w(1, 3) * a(k) + w(2, 3) * b(k)) + (w(3, 3) * d(k) + w(4, 3) * e(k))
        end do
      end associate
    end do
  end subroutine respond_to_node


  !> The rows from j to last of T = 1 - R' B.
  pure subroutine couple_rows(spread_t, j, last, rows, t)
    type(sparse_type), intent(in) :: spread_t      !< B' (n_springs x n_contact)
    integer, intent(in) :: j, last
    real(SP), intent(in) :: rows(LANES, spread_t%n_columns)
    real(SP), contiguous, intent(inout) :: t(:, :)   !< (n_springs, n_springs)
    real(SP) :: row(HALF), other(LANES - HALF), weight   ! they stay in registers
    integer :: k, p, c
    do k = 1, spread_t%n_rows
      row = 0.0_SP
      other = 0.0_SP
      do p = spread_t%first(k), spread_t%first(k + 1) - 1
        weight = real(spread_t%value(p), SP)
        c = spread_t%column(p)
        row = row - weight * rows(:HALF, c)
        other = other - weight * rows(HALF + 1:, c)
      end do
      t(j:min(last, j + HALF - 1), k) = row(:min(last - j + 1, HALF))
      t(j + HALF:last, k) = other(:last - j - HALF + 1)
      if (k >= j .and. k <= last) t(k, k) = t(k, k) + 1.0_SP
    end do
  end subroutine couple_rows


  !> x = inv(J_c) r to a residual that is small enough.
  subroutine solve_springs(self, triangle, shift, allowed, x, error)
    type(sprung_type), intent(inout), target :: self
    real(DP), contiguous, intent(in), target :: triangle(:, :)   !< L
    real(DP), intent(in), target :: shift(:)       !< D [force/length]
    real(DP), intent(in) :: allowed                !< 2-norm of the residual [force]
    real(DP), intent(inout) :: x(:)                !< (n_contact) in: r [force]; out: x [length]
    type(error_type), allocatable, intent(out) :: error
    type(stiffness_type) :: stiffness
    type(compliance_type) :: compliance
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    real(DP) :: r(size(x))
    stiffness%triangle => triangle
    stiffness%shift => shift
    stiffness%springs => self%springs
    compliance%sprung => self
    options%tolerance = 0.0_DP
    options%floor = allowed
    options%max_iterations = MOST_ITERATIONS
    options%restart = MOST_ITERATIONS
    r = x
    x = 0.0_DP
    call gmres(stiffness, compliance, r, x, options, report, error)
  end subroutine solve_springs


  !> y = J_c x.
  subroutine apply_stiffness(self, x, y)
    class(stiffness_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_contact) [length]
    real(DP), intent(out) :: y(:)                  !< (n_contact) [force]
    real(DP) :: change(size(x))
    real(DP), allocatable :: force(:)
    y = x
    call triangle_times(self%triangle, .true., y)
    call triangle_times(self%triangle, .false., y)
    y = y - self%shift * x
    allocate (force(self%springs%follow%n_rows))
    call multiply(self%springs%follow, x, force)
    call multiply(self%springs%spread, force, change)
    y = y - change
    if (self%springs%moving%n_rows == 0) return
    deallocate (force)
    allocate (force(self%springs%moving%n_rows))
    call multiply(self%springs%moving, x, force)
    call multiply(self%springs%moved, force, change)
    y = y - change
  end subroutine apply_stiffness


  !> y = inv(S - B A) x, nearly.
  subroutine apply_compliance(self, x, y)
    class(compliance_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_contact) [force]
    real(DP), intent(out) :: y(:)                  !< (n_contact) [length]
    real(SP) :: r(size(x)), z(size(x)), force(size(self%sprung%lu, 1))
    integer :: k, p
    associate (sprung => self%sprung, spread => self%sprung%springs%spread)
      r = real(x, SP)
      call transposed_times(sprung%response, r, force)
      call solve_dense(sprung%lu, sprung%pivots, force)
      do k = 1, size(r)
        do p = spread%first(k), spread%first(k + 1) - 1
          r(k) = r(k) + real(spread%value(p), SP) * force(spread%column(p))
        end do
      end do
      call transposed_times(sprung%compliance, r, z)
      y = real(z, DP) / sprung%scale
    end associate
  end subroutine apply_compliance


  include 'dense.inc'

end module amontons_woodbury_interface
