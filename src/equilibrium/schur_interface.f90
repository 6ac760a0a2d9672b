!> Schur complement of the bulk on the contact unknowns: bulk factorized with them last, contact solved on the dense interface.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, section [schur_interface]. With the unknowns that contact can reach (c) ordered last, the
!! trailing block of the Cholesky factor of the bulk is the condensed stiffness of the interface,
!!
!!     S = K_cc - K_ci inv(K_ii) K_ic = L_cc L_cc' - D,
!!
!! D is a known diagonal, added before the factorization so that it succeeds for a body supported by contact alone.
!! Statuses, friction and weights change c only: for each of them the tangent
!!
!!     J_c = C_c' ((1 + D_R) S - D_u) C_c
!!
!! is small, dense, and factorized by LU; the factor of the bulk is reused. With a factor of the current bulk this is
!! the exact inverse of the tangent J; with an older one it is a preconditioner whose quality does not depend on the status.
module amontons_schur_interface
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_sparse, only: sparse_type, sparse_from_triplets, sparse_transpose, is_same_pattern
  use amontons_matrix_reduction, only: reduction_type, analyse_reduction, reduce_matrix
  use amontons_dense, only: factorise_dense, solve_dense, find_matrix_scales, is_rank_deficient, multiply_triangular, &
    triangular_product, DENSE_OK
  use amontons_woodbury_interface, only: woodbury_type, contact_springs_type, invert_interface_stiffness, &
    factorise_spring_coupling, solve_woodbury
  use amontons_graph_partition, only: order_unknowns
  use amontons_factorization, only: cholesky_type, analyse, factorise, elimination_order, trailing_block, solve_forward, &
    solve_backward, FACTOR_OK
  use amontons_controls, only: krylov_controls_type, linear_solver_controls_type
  use amontons_constraints, only: constraints_type
  implicit none
  private
  public :: schur_interface_type, is_analysis_valid, is_factor_of, iterations_worth_factor, analyse_bulk, factorise_bulk, &
    factorise_interface, factorise_woodbury, apply_schur_interface

  integer, parameter :: N_COLUMNS_TOGETHER = 8                  !< columns of J_c computed together: a vector of doubles [-]

  !> The factors of the bulk and of the interface.
  type :: schur_interface_type
    logical :: is_analysed = .false.
    type(sparse_type), private :: analysed_map     !< C_b whose pattern was analysed
    type(sparse_type), private :: factorised_map   !< C_b of the factor
    logical :: is_ready = .false.                  !< the bulk is factorized
    integer :: n_contact = 0                       !< unknowns of the interface
    integer, allocatable :: interface_index(:)          !< (n base free) index in the interface, 0 if not on it
    integer, allocatable :: order(:)               !< (n base free) order of elimination; the interface comes last
    type(cholesky_type) :: factor
    type(reduction_type), private :: reduction
    type(sparse_type), private :: bulk             !< C_b' K C_b
    type(sparse_type), private :: matrix           !< the same with the interface's block full
    integer, allocatable, private :: target(:)     !< entry of matrix for each entry of bulk
    real(DP), allocatable, private :: triangle(:, :)   !< L_cc
    real(DP), allocatable, private :: shift(:)     !< (n_contact) D [force/length]
    real(DP), allocatable, private :: stiffness(:, :)  !< S; not allocated: not computed yet
    logical :: is_invertible = .true.              !< S has an inverse in single precision
    logical :: is_singular = .false.               !< J_c is singular: a body is not supported
    logical, private :: is_woodbury = .false.    !< the last call was factorise_woodbury
    type(woodbury_type), private :: woodbury           !< its result
    type(krylov_controls_type) :: controls
    real(DP) :: allowed_residual = 0                        !< allowed relative residual of apply_schur_interface [-]
    type(sparse_type), private :: interface_map         !< C_c (n_contact x n_reduced)
    type(sparse_type), private :: imbalance_tangent     !< D_R on the interface (n_contact x n_contact)
    integer, allocatable, private :: base_index(:)    !< (n free) base unknown of each free unknown
    integer, allocatable, private :: reduced_index(:) !< (n free) index among the reduced interface unknowns, 0 if none
    integer, private :: n_reduced = 0
    real(DP), allocatable, private :: lu(:, :)     !< factor of J_c
    integer, allocatable, private :: pivots(:)
  end type schur_interface_type

contains

  !> Whether the analysis is valid for these constraints: a rotating rigid body couples unknowns that were uncoupled before.
  pure logical function is_analysis_valid(self, base) result(is_analysed)
    type(schur_interface_type), intent(in) :: self
    type(constraints_type), intent(in) :: base     !< finished
    is_analysed = self%is_analysed
    if (is_analysed) is_analysed = is_same_pattern(base%transformation, self%analysed_map)
  end function is_analysis_valid


  !> Whether the factor is of a bulk with these constraints: knots and rigid bodies that rotate change C_b.
  pure logical function is_factor_of(self, base) result(is_same)
    type(schur_interface_type), intent(in) :: self !< with a factor
    type(constraints_type), intent(in) :: base     !< finished
    is_same = is_same_pattern(base%transformation, self%factorised_map)
    if (is_same) is_same = all(base%transformation%value == self%factorised_map%value)
  end function is_factor_of


  !> Krylov iterations that take as long as a share of the work of a new factor; 0 before the analysis. Source: operations and
  !! entries of the factor.
  pure integer function iterations_worth_factor(self, controls) result(n)
    type(schur_interface_type), intent(in) :: self
    type(linear_solver_controls_type), intent(in) :: controls
    n = 0
    if (self%is_analysed) n = int(controls%old_factor_work_ratio * self%factor%n_operations / &
      (controls%operations_per_factor_entry * self%factor%n_entries))
  end function iterations_worth_factor


  !> Orders the bulk with the interface last and analyses it. After: is_analysed, .false. if the interface is not last.
  subroutine analyse_bulk(self, stiffness, base, is_contact, error)
    type(schur_interface_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness     !< K, upper triangle (n_unknowns x n_unknowns)
    type(constraints_type), intent(in) :: base     !< boundary conditions, equations, midside_nodes: finished
    logical, intent(in) :: is_contact(:)           !< (n_unknowns) contact can act on it
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: order(:), node(:)
    integer :: i, n
    self%is_analysed = .false.
    self%is_ready = .false.
    n = base%n_free
    if (allocated(self%interface_index)) deallocate (self%interface_index)
    allocate (self%interface_index(n), node(n))
    self%n_contact = 0
    do i = 1, base%n_unknowns
      if (base%free_of(i) == 0) cycle
      node(base%free_of(i)) = (i + 2) / 3
      if (is_contact(i)) self%n_contact = self%n_contact + 1
      self%interface_index(base%free_of(i)) = merge(self%n_contact, 0, is_contact(i))
    end do
    call analyse_reduction(stiffness, base%transformation, self%reduction, self%bulk, error)
    if (allocated(error)) return
    self%analysed_map = base%transformation
    call fill_interface(self)
    call order_unknowns(self%bulk, node, base%n_unknowns / 3, order, error)
    if (allocated(error)) return
    order = [pack(order, self%interface_index(order) == 0), pack(order, self%interface_index(order) > 0)]
    call analyse(self%factor, self%matrix, order, error)
    if (allocated(error)) return
    call elimination_order(self%factor, order)
    self%is_analysed = all(self%interface_index(order(n - self%n_contact + 1:)) > 0)
    if (.not. self%is_analysed) return
    do i = 1, self%n_contact                       ! interface numbers follow the elimination order
      self%interface_index(order(n - self%n_contact + i)) = i
    end do
    call move_alloc(order, self%order)
  end subroutine analyse_bulk


  !> The pattern of the bulk with all pairs of interface unknowns, so that CHOLMOD keeps them together and last.
  subroutine fill_interface(self)
    type(schur_interface_type), intent(inout) :: self
    integer, allocatable :: members(:)
    integer :: i, k, n, p, total
    members = pack([(i, i=1, self%bulk%n_rows)], self%interface_index > 0)
    total = size(self%bulk%column) + self%n_contact * (self%n_contact + 1) / 2
    associate (matrix => self%matrix, bulk => self%bulk)
      matrix%n_rows = bulk%n_rows
      matrix%n_columns = bulk%n_columns
      if (allocated(matrix%first)) deallocate (matrix%first, matrix%column)
      if (allocated(self%target)) deallocate (self%target)
      allocate (matrix%first(bulk%n_rows + 1), matrix%column(total), self%target(size(bulk%column)))
      n = 0
      k = 0                                        ! interface unknowns found
      do i = 1, bulk%n_rows
        matrix%first(i) = n + 1
        if (self%interface_index(i) > 0) then
          k = k + 1
          call merge_row(i, members(k:))
        else
          do p = bulk%first(i), bulk%first(i + 1) - 1
            n = n + 1
            matrix%column(n) = bulk%column(p)
            self%target(p) = n
          end do
        end if
      end do
      matrix%first(bulk%n_rows + 1) = n + 1
      matrix%column = matrix%column(:n)
    end associate

  contains

    !> A row of the bulk merged with the interface unknowns from the diagonal on; both ascend.
    subroutine merge_row(row, list)
      integer, intent(in) :: row, list(:)
      integer :: q, a, b, last
      integer :: m
      q = self%bulk%first(row)
      last = self%bulk%first(row + 1)
      m = 1
      do while (q < last .or. m <= size(list))
        a = huge(a)
        b = huge(b)
        if (q < last) a = self%bulk%column(q)
        if (m <= size(list)) b = list(m)
        n = n + 1
        self%matrix%column(n) = min(a, b)
        if (a <= b) self%target(q) = n
        if (a <= b) q = q + 1
        if (b <= a) m = m + 1
      end do
    end subroutine merge_row

  end subroutine fill_interface


  !> Factorizes the bulk and extracts the condensed stiffness of the interface from its factor.
  subroutine factorise_bulk(self, stiffness, base, status, error)
    type(schur_interface_type), intent(inout) :: self    !< analysed
    type(sparse_type), intent(in) :: stiffness     !< K
    type(constraints_type), intent(in) :: base
    integer, intent(out) :: status                 !< FACTOR_...
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: shift(:)
    integer :: i, n, memory_status
    self%is_ready = .false.
    n = self%bulk%n_rows
    call reduce_matrix(self%reduction, stiffness, base%transformation, self%bulk, error)
    if (allocated(error)) return
    allocate (self%matrix%value(size(self%matrix%column)), stat=memory_status)
    if (memory_status == 0) allocate (shift(n), stat=memory_status)
    call check_memory(memory_status, error)
    if (allocated(error)) return
    self%matrix%value = 0
    do i = 1, size(self%target)                    ! gfortran does not check the memory of a temporary
      self%matrix%value(self%target(i)) = self%bulk%value(i)
    end do
    shift = merge(abs(self%bulk%value(self%bulk%first(:n))), 0.0_DP, self%interface_index > 0)
    where (self%interface_index > 0 .and. shift <= 0.0_DP) shift = maxval(shift)   ! a rigid body supported by contact alone
    deallocate (self%bulk%value)                   ! not needed any more; the factor needs the memory
    call factorise(self%factor, self%matrix, status, shift, error)
    deallocate (self%matrix%value)
    if (allocated(error) .or. status /= FACTOR_OK) return
    if (allocated(self%triangle)) deallocate (self%triangle)
    if (allocated(self%stiffness)) deallocate (self%stiffness)
    if (allocated(self%shift)) deallocate (self%shift)
    allocate (self%triangle(self%n_contact, self%n_contact), stat=memory_status)
    if (memory_status == 0) allocate (self%shift(self%n_contact), stat=memory_status)
    call check_memory(memory_status, error)
    if (allocated(error)) return
    call trailing_block(self%factor, self%triangle)
    self%factorised_map = base%transformation
    do i = 1, n
      if (self%interface_index(i) > 0) self%shift(self%interface_index(i)) = shift(i)
    end do
    self%woodbury%has_inverse = .false.
    self%is_invertible = .true.
    self%is_ready = .true.
  end subroutine factorise_bulk


  !> S = L_cc L_cc' - D.
  subroutine restore_stiffness(self, error)
    type(schur_interface_type), intent(inout) :: self
    type(error_type), allocatable, intent(inout) :: error
    integer :: k, memory_status
    if (allocated(self%stiffness)) return
    allocate (self%stiffness(self%n_contact, self%n_contact), stat=memory_status)
    call check_memory(memory_status, error)
    if (allocated(error)) return
    call triangular_product(self%triangle, self%stiffness)
    do k = 1, self%n_contact
      self%stiffness(k, k) = self%stiffness(k, k) - self%shift(k)
    end do
  end subroutine restore_stiffness


  !> Computes and factorizes J_c for the current statuses, weights and friction.
  !!
  !! After: is_complete is .false. if contact reaches unknowns that are not on the interface; then nothing else is computed.
  !! is_singular: J_c is singular to rounding; its solutions must not be used then.
  subroutine factorise_interface(self, base, constraints, imbalance_tangent, displacement_tangent, is_complete, error)
    type(schur_interface_type), intent(inout) :: self
    type(constraints_type), intent(in) :: base     !< without contact rows
    type(constraints_type), intent(in) :: constraints    !< with them
    type(sparse_type), intent(in) :: imbalance_tangent      !< D_R (n_unknowns x n_unknowns) [-]
    type(sparse_type), intent(in) :: displacement_tangent   !< D_u (n_unknowns x n_unknowns) [force/length]
    logical, intent(out) :: is_complete
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: d_u
    real(DP), allocatable :: row(:), column(:)     ! (n_reduced) sizes of the rows and columns of J_c
    integer :: status
    call map_interface(self, base, constraints, is_complete, error)
    if (allocated(error) .or. .not. is_complete) return
    call restore_stiffness(self, error)
    if (allocated(error)) return
    self%is_woodbury = .false.
    call restrict_square(self, base, imbalance_tangent, self%imbalance_tangent, error)
    if (allocated(error)) return
    call restrict_square(self, base, displacement_tangent, d_u, error)
    if (allocated(error)) return
    call fill_interface_tangent(self, sparse_transpose(self%interface_map), sparse_transpose(d_u), error)
    if (allocated(error)) return
    if (allocated(self%pivots)) deallocate (self%pivots)
    allocate (self%pivots(self%n_reduced), row(self%n_reduced), column(self%n_reduced))
    call find_matrix_scales(self%lu, row, column)
    call factorise_dense(self%lu, self%pivots, status)
    self%is_singular = status /= DENSE_OK
    if (.not. self%is_singular) self%is_singular = is_rank_deficient(self%lu, self%pivots, row, column)
  end subroutine factorise_interface


  !> Checks the status of an allocation. Errors: EXIT_SOLVER.
  subroutine check_memory(memory_status, error)
    integer, intent(in) :: memory_status               !< status of an allocation
    type(error_type), allocatable, intent(inout) :: error
    if (memory_status /= 0) call set_error(error, EXIT_SOLVER, 'Not enough memory for the interface of contact.')
  end subroutine check_memory


  !> The same for contact by springs only (Woodbury formula). After: is_fit is .false. if S is singular or springs are too stiff.
  subroutine factorise_woodbury(self, base, constraints, springs, is_complete, is_fit, error)
    type(schur_interface_type), intent(inout) :: self
    type(constraints_type), intent(in) :: base     !< without contact rows
    type(constraints_type), intent(in) :: constraints    !< the same
    type(contact_springs_type), intent(in) :: springs      !< on all unknowns instead of those of the interface
    logical, intent(out) :: is_complete, is_fit
    type(error_type), allocatable, intent(out) :: error
    type(contact_springs_type) :: restricted_springs
    is_fit = .false.
    self%is_singular = .false.
    call map_interface(self, base, constraints, is_complete, error)
    if (allocated(error) .or. .not. is_complete) return
    if (self%n_reduced < self%n_contact) return
    if (.not. self%woodbury%has_inverse) then
      if (allocated(self%stiffness)) deallocate (self%stiffness)
      call invert_interface_stiffness(self%woodbury, self%triangle, self%shift, error)
      if (allocated(error)) return
      self%is_invertible = self%woodbury%has_inverse
      if (.not. self%is_invertible) return
    end if
    call restrict_springs(self, base, springs, restricted_springs, error)
    if (allocated(error)) return
    self%imbalance_tangent = empty_square(self%n_contact)
    call factorise_spring_coupling(self%woodbury, restricted_springs, is_fit, error)
    self%is_woodbury = is_fit
  end subroutine factorise_woodbury


  !> The springs on the interface.
  subroutine restrict_springs(self, base, springs, restricted_springs, error)
    type(schur_interface_type), intent(in) :: self
    type(constraints_type), intent(in) :: base
    type(contact_springs_type), intent(in) :: springs
    type(contact_springs_type), intent(out) :: restricted_springs
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: transposed
    call restrict_rows(self, base, springs%force_distribution, restricted_springs%force_distribution, error)
    if (allocated(error)) return
    call restrict_rows(self, base, sparse_transpose(springs%spring_tangent), transposed, error)
    if (allocated(error)) return
    restricted_springs%spring_tangent = sparse_transpose(transposed)
    call restrict_rows(self, base, springs%distribution_change, restricted_springs%distribution_change, error)
    if (allocated(error)) return
    call restrict_rows(self, base, sparse_transpose(springs%projection_gradient), transposed, error)
    if (.not. allocated(error)) restricted_springs%projection_gradient = sparse_transpose(transposed)
  end subroutine restrict_springs


  !> A matrix without entries.
  pure function empty_square(n) result(matrix)
    integer, intent(in) :: n
    type(sparse_type) :: matrix
    integer :: i
    matrix%n_rows = n
    matrix%n_columns = n
    matrix%first = [(1, i=1, n + 1)]
    allocate (matrix%column(0), matrix%value(0))
  end function empty_square


  !> The rows of C_b' M on the interface.
  subroutine restrict_rows(self, base, matrix, restricted_springs, error)
    type(schur_interface_type), intent(in) :: self
    type(constraints_type), intent(in) :: base
    type(sparse_type), intent(in) :: matrix        !< (n_unknowns x n)
    type(sparse_type), intent(out) :: restricted_springs        !< (n_contact x n)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, a, p, n, pass
    do pass = 1, 2
      n = 0
      do i = 1, matrix%n_rows
        if (matrix%first(i) == matrix%first(i + 1)) cycle
        do a = base%transformation%first(i), base%transformation%first(i + 1) - 1
          if (self%interface_index(base%transformation%column(a)) == 0) cycle
          do p = matrix%first(i), matrix%first(i + 1) - 1
            n = n + 1
            if (pass == 1) cycle
            row(n) = self%interface_index(base%transformation%column(a))
            column(n) = matrix%column(p)
            value(n) = base%transformation%value(a) * matrix%value(p)
          end do
        end do
      end do
      if (pass == 1) allocate (row(n), column(n), value(n))
    end do
    call sparse_from_triplets(self%n_contact, matrix%n_columns, row, column, value, restricted_springs, error)
  end subroutine restrict_rows


  !> Woodbury solution for a right-hand side on the free unknowns of the interface; C_c is a permutation here.
  subroutine solve_permuted(self, r)
    type(schur_interface_type), intent(inout), target :: self
    real(DP), intent(inout) :: r(:)                !< (n_contact) in the order of the free unknowns
    type(error_type), allocatable :: error         ! no memory: the result is wrong, and GMRES detects it
    real(DP) :: t(self%n_contact)
    integer :: k
    associate (column_of => self%interface_map%column, first => self%interface_map%first)
      t = [(r(column_of(first(k))), k=1, self%n_contact)]
      call solve_woodbury(self%woodbury, self%triangle, self%shift, &
        self%controls%single_precision_share * self%allowed_residual, t, error)
      do k = 1, self%n_contact
        r(column_of(first(k))) = t(k)
      end do
    end associate
  end subroutine solve_permuted


  !> C_c, and the indices of the free unknowns in bulk and interface.
  subroutine map_interface(self, base, constraints, is_complete, error)
    type(schur_interface_type), intent(inout) :: self
    type(constraints_type), intent(in) :: base, constraints
    logical, intent(out) :: is_complete
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, c, p, n
    if (allocated(self%base_index)) deallocate (self%base_index, self%reduced_index)
    allocate (self%base_index(constraints%n_free), self%reduced_index(constraints%n_free))
    self%n_reduced = 0
    do i = 1, constraints%n_unknowns
      if (constraints%free_of(i) == 0) cycle
      self%base_index(constraints%free_of(i)) = base%free_of(i)
      c = self%interface_index(base%free_of(i))
      if (c > 0) self%n_reduced = self%n_reduced + 1
      self%reduced_index(constraints%free_of(i)) = merge(self%n_reduced, 0, c > 0)
    end do
    is_complete = .false.
    allocate (row(size(constraints%transformation%column)), column(size(constraints%transformation%column)), &
      value(size(constraints%transformation%column)))
    n = 0
    do i = 1, base%n_unknowns
      if (base%free_of(i) == 0) cycle
      c = self%interface_index(base%free_of(i))
      if (c == 0 .and. constraints%free_of(i) == 0) return
      if (c == 0) cycle
      do p = constraints%transformation%first(i), constraints%transformation%first(i + 1) - 1
        n = n + 1
        row(n) = c
        column(n) = self%reduced_index(constraints%transformation%column(p))
        value(n) = constraints%transformation%value(p)
        if (column(n) == 0) return
      end do
    end do
    is_complete = .true.
    call sparse_from_triplets(self%n_contact, self%n_reduced, row(:n), column(:n), value(:n), self%interface_map, error)
  end subroutine map_interface


  !> C_b' M C_b on the interface alone.
  subroutine restrict_square(self, base, matrix, restricted, error)
    type(schur_interface_type), intent(in) :: self
    type(constraints_type), intent(in) :: base
    type(sparse_type), intent(in) :: matrix        !< (n_unknowns x n_unknowns)
    type(sparse_type), intent(out) :: restricted   !< (n_contact x n_contact)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, p, n, pass
    do pass = 1, 2
      n = 0
      do i = 1, matrix%n_rows
        do p = matrix%first(i), matrix%first(i + 1) - 1
          call put(i, matrix%column(p), matrix%value(p))
        end do
      end do
      if (pass == 1) allocate (row(n), column(n), value(n))
    end do
    call sparse_from_triplets(self%n_contact, self%n_contact, row, column, value, restricted, error)

  contains

    !> One entry, spread over the free unknowns on which its row and its column depend.
    subroutine put(r, c, v)
      integer, intent(in) :: r, c
      real(DP), intent(in) :: v
      integer :: a, b
      do a = base%transformation%first(r), base%transformation%first(r + 1) - 1
        if (self%interface_index(base%transformation%column(a)) == 0) cycle
        do b = base%transformation%first(c), base%transformation%first(c + 1) - 1
          if (self%interface_index(base%transformation%column(b)) == 0) cycle
          n = n + 1
          if (pass == 1) cycle
          row(n) = self%interface_index(base%transformation%column(a))
          column(n) = self%interface_index(base%transformation%column(b))
          value(n) = base%transformation%value(a) * v * base%transformation%value(b)
        end do
      end do
    end subroutine put

  end subroutine restrict_square


  !> J_c = C_c' ((1 + D_R) S - D_u) C_c, some columns at a time; threads share them.
  subroutine fill_interface_tangent(self, relation_t, d_u_t, error)
    type(schur_interface_type), intent(inout) :: self
    type(sparse_type), intent(in) :: relation_t    !< C_c' (n_reduced x n_contact)
    type(sparse_type), intent(in) :: d_u_t         !< D_u' (n_contact x n_contact)
    type(error_type), allocatable, intent(inout) :: error
    integer :: j, memory_status
    if (allocated(self%lu)) deallocate (self%lu)
    allocate (self%lu(self%n_reduced, self%n_reduced), stat=memory_status)
    call check_memory(memory_status, error)
    if (allocated(error)) return
    !$omp parallel do schedule(static)
    do j = 1, self%n_reduced, N_COLUMNS_TOGETHER
      call fill_columns(self, relation_t, d_u_t, j, min(j + N_COLUMNS_TOGETHER - 1, self%n_reduced))
    end do
    !$omp end parallel do
  end subroutine fill_interface_tangent


  !> Columns of J_c, contiguous in memory, so that one pass over the sparse matrices serves all of them.
  subroutine fill_columns(self, relation_t, d_u_t, first, last)
    type(schur_interface_type), intent(inout) :: self
    type(sparse_type), intent(in) :: relation_t, d_u_t
    integer, intent(in) :: first, last             !< at most N_COLUMNS_TOGETHER columns
    real(DP) :: t(N_COLUMNS_TOGETHER, self%n_contact), w(N_COLUMNS_TOGETHER, self%n_contact), row(N_COLUMNS_TOGETHER)
    integer :: j, m, p, q, k
    t = 0.0_DP
    do j = first, last
      m = j - first + 1
      do p = relation_t%first(j), relation_t%first(j + 1) - 1
        t(m, :) = t(m, :) + relation_t%value(p) * self%stiffness(:, relation_t%column(p))
      end do
    end do
    w = t
    do k = 1, self%n_contact
      do p = self%imbalance_tangent%first(k), self%imbalance_tangent%first(k + 1) - 1
        w(:, k) = w(:, k) + self%imbalance_tangent%value(p) * t(:, self%imbalance_tangent%column(p))
      end do
    end do
    do j = first, last
      m = j - first + 1
      do p = relation_t%first(j), relation_t%first(j + 1) - 1
        k = relation_t%column(p)
        do q = d_u_t%first(k), d_u_t%first(k + 1) - 1
          w(m, d_u_t%column(q)) = w(m, d_u_t%column(q)) - relation_t%value(p) * d_u_t%value(q)
        end do
      end do
    end do
    do k = 1, self%n_reduced
      row = 0.0_DP
      do p = relation_t%first(k), relation_t%first(k + 1) - 1
        row = row + relation_t%value(p) * w(:, relation_t%column(p))
      end do
      self%lu(k, first:last) = row(:last - first + 1)
    end do
  end subroutine fill_columns


  !> x = inv(J) r with the factorized bulk: forward substitution in the bulk, interface, backward substitution in the bulk. The
  !! forward substitution is skipped where only the interface has a residual.
  subroutine apply_schur_interface(self, r, x)
    type(schur_interface_type), intent(inout), target :: self
    real(DP), intent(in) :: r(:)                   !< (n free) [force]
    real(DP), intent(out) :: x(:)                  !< (n free) [length]
    real(DP), allocatable :: b(:), y(:), h(:), g(:), r_c(:)
    integer :: n, m, j, k, p
    n = size(self%order)
    m = n - self%n_contact
    allocate (b(n), y(n), h(self%n_contact), r_c(self%n_reduced))
    b = 0.0_DP
    do j = 1, size(r)
      if (self%reduced_index(j) == 0) b(self%base_index(j)) = r(j)
      if (self%reduced_index(j) > 0) r_c(self%reduced_index(j)) = r(j)
    end do
    y = 0.0_DP
    h = 0.0_DP
    if (norm2(b) > self%controls%bulk_share * self%allowed_residual) then
      call solve_forward(self%factor, b(self%order), y)
      h = y(m + 1:)
      call multiply_triangular(self%triangle, .false., h)   ! - K_ci inv(K_ii) r_i
    end if
    g = h
    do k = 1, self%n_contact
      do p = self%imbalance_tangent%first(k), self%imbalance_tangent%first(k + 1) - 1
        g(k) = g(k) + self%imbalance_tangent%value(p) * h(self%imbalance_tangent%column(p))
      end do
    end do
    do k = 1, self%n_contact
      do p = self%interface_map%first(k), self%interface_map%first(k + 1) - 1
        r_c(self%interface_map%column(p)) = r_c(self%interface_map%column(p)) + self%interface_map%value(p) * g(k)
      end do
    end do
    if (self%is_woodbury) then
      call solve_permuted(self, r_c)
    else
      call solve_dense(self%lu, self%pivots, r_c)
    end if
    do k = 1, self%n_contact
      h(k) = 0.0_DP
      do p = self%interface_map%first(k), self%interface_map%first(k + 1) - 1
        h(k) = h(k) + self%interface_map%value(p) * r_c(self%interface_map%column(p))
      end do
    end do
    call multiply_triangular(self%triangle, .true., h)
    y(m + 1:) = h
    call solve_backward(self%factor, y, b)
    y(self%order) = b
    do j = 1, size(x)
      if (self%reduced_index(j) > 0) then
        x(j) = r_c(self%reduced_index(j))
      else
        x(j) = y(self%base_index(j))
      end if
    end do
  end subroutine apply_schur_interface

end module amontons_schur_interface
