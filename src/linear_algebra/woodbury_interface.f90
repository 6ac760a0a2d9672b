!> Woodbury preconditioner and GMRES for the interface system of compliant contact.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "Contact unknowns last". The change of the contact forces is a product of thin matrices,
!!
!!     dF_c = (B A + M X) du,
!!
!! A spring has three columns in B A (the distribution of its force over its nodes, and the change of that force) and two in M X
!! (the change of the distribution as its projection on the master moves). GMRES solves the tangent of the interface,
!! J_c = S - B A - M X, in double precision. The preconditioner is the Sherman-Morrison-Woodbury formula for S - B A (Golub and
!! Van Loan, Matrix Computations, 4th ed., section 2.1.4),
!!
!!     inv(S - B A) = inv(S) + inv(S) B inv(T) A inv(S),      T = 1 - A inv(S) B,
!!
!! in single precision, S scaled by its largest diagonal entry s, A likewise.
module amontons_woodbury_interface
  use amontons_kinds, only: DP, SP, WP => SP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_sparse, only: sparse_type, sparse_transpose, multiply
  use amontons_blas_lapack, only: getrf => sgetrf, laswp => slaswp, trsm => strsm, gemm => sgemm, getrs => sgetrs, &
    potrf => spotrf, potri => spotri, gemv => sgemv
  use amontons_dense, only: multiply_triangular, DENSE_OK, DENSE_SINGULAR, MIN_THREADED_SIZE, BLOCK_COLUMNS
  use amontons_krylov, only: operator_type, krylov_options_type, krylov_report_type, gmres
  implicit none
  private
  public :: woodbury_type, contact_springs_type, invert_interface_stiffness, factorise_spring_coupling, solve_woodbury

  real(SP), parameter :: MIN_SINGLE_PIVOT = 1.0e-4_SP     !< least pivot of S over its diagonal for which S is inverted [-]
  real(SP), parameter :: MAX_COUPLING_ENTRY = 1.0e4_SP          !< largest entry of T: stiffer springs need double precision [-]
  integer, parameter :: T_ROWS = 32                 !< rows of T computed together
  integer, parameter :: HALF_T_ROWS = T_ROWS / 2
  integer, parameter :: TILE_UNKNOWNS = 64                  !< unknowns of the interface in one tile of the transposition
  integer, parameter :: MAX_GMRES_ITERATIONS = 60       !< of a solution; the caller handles the remaining residual

  !> The springs of the current contact state, on the interface.
  type :: contact_springs_type
    type(sparse_type) :: force_distribution                    !< B (n_contact x n_springs) [-]
    type(sparse_type) :: spring_tangent                    !< A (n_springs x n_contact) [force/length]
    type(sparse_type) :: distribution_change                     !< M (n_contact x n_moving) [force]
    type(sparse_type) :: projection_gradient                    !< X (n_moving x n_contact) [1/length]
  end type contact_springs_type

  !> The data of the preconditioner.
  type :: woodbury_type
    logical :: has_inverse = .false.                !< compliance belongs to the current bulk factor
    type(contact_springs_type) :: springs
    real(DP), private :: scale = 1                 !< s [force/length]
    real(SP), allocatable, private :: compliance(:, :)   !< inv(S / s) (n_contact, n_contact) [-]
    real(SP), allocatable, private :: response(:, :)     !< R = (A inv(S))' (n_contact, n_springs) [-]
    real(SP), allocatable, private :: lu(:, :)     !< T factorised
    integer, allocatable, private :: pivots(:)
  end type woodbury_type

  !> J_c as an operator.
  type, extends(operator_type) :: interface_stiffness_type
    real(DP), pointer, contiguous :: triangle(:, :) => null()  !< L_cc
    real(DP), pointer :: shift(:) => null()        !< D
    type(contact_springs_type), pointer :: springs => null()
  contains
    procedure :: apply => apply_stiffness
  end type interface_stiffness_type

  !> The approximate inverse of J_c as an operator.
  type, extends(operator_type) :: interface_compliance_type
    type(woodbury_type), pointer :: woodbury => null()
  contains
    procedure :: apply => apply_compliance
  end type interface_compliance_type

contains

  !> inv(S) for a new factor of the bulk, S = L L' - D. Sets has_inverse, unless a body is supported too weakly for an inverse.
  subroutine invert_interface_stiffness(self, triangle, shift, error)
    type(woodbury_type), intent(inout) :: self
    real(DP), intent(in) :: triangle(:, :)         !< L (n_contact, n_contact), zero above the diagonal
    real(DP), intent(in) :: shift(:)               !< D (n_contact) [force/length]
    type(error_type), allocatable, intent(out) :: error
    real(SP), allocatable :: single(:, :)
    real(DP), allocatable :: diagonal(:)           ! of S [force/length]
    real(DP) :: root
    integer :: i, n, no_memory, status
    n = size(shift)
    self%has_inverse = .false.
    if (allocated(self%compliance)) deallocate (self%compliance)
    allocate (self%compliance(n, n), stat=no_memory)
    if (no_memory == 0) allocate (single(n, n), stat=no_memory)
    call check_allocation(no_memory, error)
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
    call triangular_product(single, self%compliance)
    do i = 1, n
      self%compliance(i, i) = self%compliance(i, i) - real(shift(i) / self%scale, SP)
    end do
    deallocate (single)
    call invert_spd(self%compliance, MIN_SINGLE_PIVOT, status)
    self%has_inverse = status == DENSE_OK
  end subroutine invert_interface_stiffness


  !> T for the current springs, and its factor. Sets is_accurate to .false. if single precision is not enough.
  subroutine factorise_spring_coupling(self, springs, is_accurate, error)
    type(woodbury_type), intent(inout) :: self       !< with inv(S)
    type(contact_springs_type), intent(in) :: springs
    logical, intent(out) :: is_accurate
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: spread_t
    integer :: status
    self%springs = springs
    is_accurate = .false.
    call allocate_coupling(self, springs%spring_tangent%n_rows, error)
    if (allocated(error)) return
    spread_t = sparse_transpose(springs%force_distribution)
    call compute_coupling(self, spread_t)
    if (.not. all(abs(self%lu) < MAX_COUPLING_ENTRY)) return
    call factorise_dense(self%lu, self%pivots, status)
    is_accurate = status == DENSE_OK
  end subroutine factorise_spring_coupling


  !> Allocates R and T.
  subroutine allocate_coupling(self, n, error)
    type(woodbury_type), intent(inout) :: self
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
    call check_allocation(no_memory, error)
  end subroutine allocate_coupling


  !> Errors: EXIT_SOLVER if an allocation failed.
  subroutine check_allocation(no_memory, error)
    integer, intent(in) :: no_memory               !< status of an allocation
    type(error_type), allocatable, intent(inout) :: error
    if (no_memory /= 0) call set_error(error, EXIT_SOLVER, 'Not enough memory for the interface of contact.')
  end subroutine check_allocation


  !> R = (A inv(S))' and T = 1 - A inv(S) B. Threads share the springs; each column of R is computed once, in blocks for the
  !! products with B.
  subroutine compute_coupling(self, spread_t)
    type(woodbury_type), intent(inout) :: self
    type(sparse_type), intent(in) :: spread_t      !< B' (n_springs x n_contact)
    real(SP), allocatable :: rows(:, :)
    integer :: n, j, last
    n = size(self%lu, 1)
    !$omp parallel private(rows, last)
    allocate (rows(T_ROWS, size(self%compliance, 1)), source=0.0_SP)
    !$omp do schedule(static)
    do j = 1, n, T_ROWS
      last = min(j + T_ROWS - 1, n)
      call compute_response_columns(self%springs%spring_tangent, self%scale, self%compliance, j, last, self%response)
      call copy_response_rows(self%response, j, last, rows)
      call compute_coupling_rows(spread_t, j, last, rows, self%lu)
    end do
    !$omp end do
    deallocate (rows)
    !$omp end parallel
  end subroutine compute_coupling


  !> Columns j to last of R.
  subroutine compute_response_columns(follow, scale, compliance, j, last, response)
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
        call compute_node_response(follow, scale, compliance, i, response(:, i), response(:, i + 1), response(:, i + 2))
        i = i + 3
        cycle
      end if
      response(:, i) = 0.0_SP
      do p = follow%first(i), follow%first(i + 1) - 1
        response(:, i) = response(:, i) + real(follow%value(p) / scale, SP) * compliance(:, follow%column(p))
      end do
      i = i + 1
    end do
  end subroutine compute_response_columns


  !> Transposes these columns to rows, tile by tile: a tile is still in the cache for the next column.
  pure subroutine copy_response_rows(response, j, last, rows)
    real(SP), contiguous, intent(in) :: response(:, :)
    integer, intent(in) :: j, last
    real(SP), intent(inout) :: rows(T_ROWS, size(response, 1))
    integer :: i, k, p
    do k = 1, size(response, 1), TILE_UNKNOWNS
      do p = j, last
        do i = k, min(k + TILE_UNKNOWNS - 1, size(response, 1))
          rows(p - j + 1, i) = response(i, p)
        end do
      end do
    end do
  end subroutine copy_response_rows


  !> Whether three rows, those of the springs of one node, have the same columns.
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


  !> Three columns of R, of springs with the same columns in A: four columns of inv(S) at a time, each read once.
  pure subroutine compute_node_response(follow, scale, compliance, i, x, y, z)
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
      c = follow%column(follow%first(i))           ! columns with weight zero fill the last block of four
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
  end subroutine compute_node_response


  !> Rows j to last of T = 1 - R' B.
  pure subroutine compute_coupling_rows(spread_t, j, last, rows, t)
    type(sparse_type), intent(in) :: spread_t      !< B' (n_springs x n_contact)
    integer, intent(in) :: j, last
    real(SP), intent(in) :: rows(T_ROWS, spread_t%n_columns)
    real(SP), contiguous, intent(inout) :: t(:, :)   !< (n_springs, n_springs)
    real(SP) :: row(HALF_T_ROWS), other(T_ROWS - HALF_T_ROWS), weight   ! kept in registers
    integer :: k, p, c
    do k = 1, spread_t%n_rows
      row = 0.0_SP
      other = 0.0_SP
      do p = spread_t%first(k), spread_t%first(k + 1) - 1
        weight = real(spread_t%value(p), SP)
        c = spread_t%column(p)
        row = row - weight * rows(:HALF_T_ROWS, c)
        other = other - weight * rows(HALF_T_ROWS + 1:, c)
      end do
      t(j:min(last, j + HALF_T_ROWS - 1), k) = row(:min(last - j + 1, HALF_T_ROWS))
      t(j + HALF_T_ROWS:last, k) = other(:last - j - HALF_T_ROWS + 1)
      if (k >= j .and. k <= last) t(k, k) = t(k, k) + 1.0_SP
    end do
  end subroutine compute_coupling_rows


  !> Solves J_c x = r by GMRES to a given residual.
  subroutine solve_woodbury(self, triangle, shift, allowed, x, error)
    type(woodbury_type), intent(inout), target :: self
    real(DP), contiguous, intent(in), target :: triangle(:, :)   !< L
    real(DP), intent(in), target :: shift(:)       !< D [force/length]
    real(DP), intent(in) :: allowed                !< limit of the 2-norm of the residual [force]
    real(DP), intent(inout) :: x(:)                !< (n_contact) in: r [force]; out: x [length]
    type(error_type), allocatable, intent(out) :: error
    type(interface_stiffness_type) :: stiffness
    type(interface_compliance_type) :: compliance
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    real(DP) :: r(size(x))
    stiffness%triangle => triangle
    stiffness%shift => shift
    stiffness%springs => self%springs
    compliance%woodbury => self
    options%tolerance = 0.0_DP
    options%absolute_tolerance = allowed
    options%max_iterations = MAX_GMRES_ITERATIONS
    options%restart = MAX_GMRES_ITERATIONS
    r = x
    x = 0.0_DP
    call gmres(stiffness, compliance, r, x, options, report, error)
  end subroutine solve_woodbury


  !> y = J_c x.
  subroutine apply_stiffness(self, x, y)
    class(interface_stiffness_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_contact) [length]
    real(DP), intent(out) :: y(:)                  !< (n_contact) [force]
    real(DP) :: change(size(x))
    real(DP), allocatable :: force(:)
    y = x
    call multiply_triangular(self%triangle, .true., y)
    call multiply_triangular(self%triangle, .false., y)
    y = y - self%shift * x
    allocate (force(self%springs%spring_tangent%n_rows))
    call multiply(self%springs%spring_tangent, x, force)
    call multiply(self%springs%force_distribution, force, change)
    y = y - change
    if (self%springs%projection_gradient%n_rows == 0) return
    deallocate (force)
    allocate (force(self%springs%projection_gradient%n_rows))
    call multiply(self%springs%projection_gradient, x, force)
    call multiply(self%springs%distribution_change, force, change)
    y = y - change
  end subroutine apply_stiffness


  !> y = inv(S - B A) x, approximately.
  subroutine apply_compliance(self, x, y)
    class(interface_compliance_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_contact) [force]
    real(DP), intent(out) :: y(:)                  !< (n_contact) [length]
    real(SP) :: r(size(x)), z(size(x)), force(size(self%woodbury%lu, 1))
    integer :: k, p
    associate (coupling => self%woodbury, spread => self%woodbury%springs%force_distribution)
      r = real(x, SP)
      call multiply_dense_transpose(coupling%response, r, force)
      call solve_dense(coupling%lu, coupling%pivots, force)
      do k = 1, size(r)
        do p = spread%first(k), spread%first(k + 1) - 1
          r(k) = r(k) + real(spread%value(p), SP) * force(spread%column(p))
        end do
      end do
      call multiply_dense_transpose(coupling%compliance, r, z)
      y = real(z, DP) / coupling%scale
    end associate
  end subroutine apply_compliance


  include 'dense.inc'

end module amontons_woodbury_interface
