!> Krylov methods with the two-level preconditioner over the ranks: unknowns, matrix, U and vectors are divided.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Each rank has a domain: its own unknowns and the halo, one layer of unknowns of other ranks (`halo`). It holds A on its domain.
!!
!!     inv(A)  ~  sum over domains D R' inv(U'U) R D  +  Z inv(Z'AZ) Z'
!!
!! R takes the unknowns of a domain from all, U is the incomplete factor of A on the domain, and D is diagonal with 1 / sqrt(m) at
!! an unknown of m domains, so that D R'R D sums to the identity and the sum stays symmetric. With the layer in common, iterations
!! hardly grow with the number of ranks; without it they grow by a quarter (decision 0012). Z'AZ is the sum of what each rank
!! computes from its rows; its factor is divided among the ranks, if they are few (`divided_coarse_factor`).
!!
!! A whole matrix is divided by copies of its entries. Of a matrix of which each rank has the part of its own elements, the entries
!! on the borders are exchanged (`domain_matrix`).
!!
!! A skew-symmetric D may be subtracted from A: GMRES then solves (A - D) x = b, with the same preconditioner. Each rank has the
!! rows of D of its own unknowns; their columns lie on its domain, because D has the pattern of A.
!!
!! An iteration has three messages to each neighbour (the direction; the residual; what U gives in the halo), a sum of the coarse
!! residual Z'r, of its border if the factor of Z'AZ is divided, and four scalars; with GMRES a scalar for each vector kept. Sums
!! are in the order of the ranks. Conjugate gradients and GMRES apply the second level to what the first one leaves, as on one
!! rank: one message more, and a little more than half of the iterations.
!! References: those of `two_level_preconditioner`; Cai and Sarkis, SIAM J. Sci. Comput. 21 (1999) 792, and Smith, Bjorstad, Gropp,
!! Domain Decomposition, Cambridge 1996, sec. 1.3 (domains with a common layer).
module amontons_distributed_two_level
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_INTERNAL
  use amontons_sparse, only: sparse_type, multiply, multiply_symmetric, alike_rows
  use amontons_krylov, only: operator_type, krylov_options_type, krylov_report_type, conjugate_gradients, gmres
  use amontons_two_level_preconditioner, only: two_level_preconditioner_type, take_coarse_space, factorise_first_level, &
    factorise_second_level, apply_first_level, restrict_residual, solve_second_level, add_correction, discard_preconditioner
  use amontons_divided_coarse_factor, only: divided_coarse_factor_type
  use amontons_halo, only: halo_type, halo_list_type, find_halo, list_halos, find_halo_in_lists, fill_halo, return_halo
  use amontons_domain_matrix, only: domain_sum_type, plan_domain_sum, sum_domain
  use amontons_mpi_ranks, only: this_rank, n_ranks, sum_over_ranks, join_parts, min_over_ranks, share_error
  implicit none
  private
  public :: distributed_two_level_type, create_distributed_two_level, update_distributed_two_level, &
    renew_distributed_matrix, apply_distributed_two_level, solve_distributed_two_level, solve_distributed_unsymmetric, &
    own_unknowns, compare_messages, describe_messages, discard_domain

  !> A and its preconditioner on the domain of this rank.
  type :: distributed_two_level_type
    type(halo_type) :: halo                        !< own unknowns and the layer around them
    integer, allocatable :: place(:)               !< (n of A) place of each unknown, rank by rank
    type(sparse_type) :: matrix                    !< A on the domain, upper triangle
    integer, allocatable :: source(:)              !< the entry of A for each of its entries; not allocated: A is in parts
    type(domain_sum_type) :: parts                 !< its entries from the parts of the ranks
    integer(I64) :: n_entries = 0                  !< of A
    type(two_level_preconditioner_type) :: levels  !< U of the domain; Z on the domain; the factor of Z'AZ
    real(DP), allocatable :: weight(:)             !< D on the domain [-]
    integer :: n_coarse = 0                        !< coarse unknowns that an iteration sums over the ranks
    integer :: n_iterations = 0                    !< applications of the preconditioner so far
    real(DP) :: most(5) = 0                        !< of all ranks: own unknowns, halo, neighbours, messages and bytes sent so far
  end type distributed_two_level_type

  !> A, or A - D, on own unknowns.
  type, extends(operator_type) :: divided_matrix_type
    type(distributed_two_level_type), pointer :: solver => null()
    type(sparse_type) :: skew                      !< rows of D (n_own x unknowns of the domain); not built: D = 0
  contains
    procedure :: apply => apply_matrix
    procedure :: complete => complete_over_ranks
  end type divided_matrix_type

  !> The preconditioner on own unknowns.
  type, extends(operator_type) :: divided_preconditioner_type
    type(distributed_two_level_type), pointer :: solver => null()
    logical :: is_deflated = .false.               !< the second level follows the first one; else they are added
  contains
    procedure :: apply => apply_levels
    procedure :: correct => correct_start
  end type divided_preconditioner_type

contains

  !> Divides the pattern of a matrix and a coarse space.
  subroutine create_distributed_two_level(self, pattern, owner, coarse_space, is_held)
    type(distributed_two_level_type), intent(inout) :: self
    type(sparse_type), intent(in) :: pattern       !< of A, or of the part of this rank: upper triangle
    integer, intent(in) :: owner(:)                !< (n) rank of each unknown, from 0
    type(two_level_preconditioner_type), intent(in) :: coarse_space   !< Z of A
    logical, intent(in), optional :: is_held(:)    !< (n) elements of this rank contribute to the unknown: A is in parts
    type(halo_list_type) :: halos
    real(DP) :: n_entries(1)
    integer :: r, i, n
    if (allocated(self%source)) deallocate (self%source)
    if (allocated(self%matrix%value)) deallocate (self%matrix%value)
    if (present(is_held)) then
      call list_halos(halos, pattern, owner)
      call find_halo_in_lists(self%halo, halos, owner, this_rank())
      call plan_domain_sum(self%parts, pattern, is_held, owner, halos, self%matrix)
    else
      call find_halo(self%halo, pattern, owner, this_rank())
      call take_submatrix(pattern, self%halo%unknown, self%matrix, self%source)
    end if
    self%matrix%n_alike = alike_rows(self%matrix)
    if (allocated(self%place)) deallocate (self%place)
    allocate (self%place(size(owner)))
    n = 0
    do r = 0, n_ranks() - 1
      do i = 1, size(owner)
        if (owner(i) /= r) cycle
        n = n + 1
        self%place(i) = n
      end do
    end do
    n_entries = count_share(self)
    call sum_over_ranks(n_entries)
    self%n_entries = nint(n_entries(1), I64)
    call take_coarse_space(self%levels, coarse_space, self%halo%unknown)
    self%levels%n_own = self%halo%n_own
    if (.not. allocated(self%levels%coarse_factor)) allocate (divided_coarse_factor_type :: self%levels%coarse_factor)
    self%weight = [1.0_DP / sqrt(self%halo%n_holders), (0.0_DP, i=self%halo%n_own + 1, size(self%halo%unknown))]
    call fill_halo(self%halo, self%weight)
  end subroutine create_distributed_two_level


  !> The entries of A of this rank: those of its own rows, half where another rank has them, too.
  pure real(DP) function count_share(self) result(n)
    type(distributed_two_level_type), intent(in) :: self
    integer :: i
    n = 0
    associate (first => self%matrix%first, n_own => self%halo%n_own)
      do i = 1, n_own
        n = n + real(first(i + 1) - first(i), DP) - 0.5_DP * real(count(self%matrix%column(first(i):first(i + 1) - 1) > n_own), DP)
      end do
    end associate
  end function count_share


  !> The pattern of a matrix between some unknowns, in their order: upper triangle, and the entry of the matrix for each of its own.
  subroutine take_submatrix(pattern, members, matrix, source)
    type(sparse_type), intent(in) :: pattern       !< upper triangle
    integer, intent(in) :: members(:)              !< unknowns
    type(sparse_type), intent(out) :: matrix       !< without values
    integer, allocatable, intent(out) :: source(:)
    integer :: place(pattern%n_rows), next(size(members))
    integer :: pass, i, j, p, row
    place = 0
    place(members) = [(i, i=1, size(members))]
    matrix = sparse_type(size(members), size(members))
    allocate (matrix%first(size(members) + 1), source=0)
    do pass = 1, 2
      do i = 1, size(members)
        do p = pattern%first(members(i)), pattern%first(members(i) + 1) - 1
          j = place(pattern%column(p))
          if (j == 0) cycle
          row = min(i, j)
          if (pass == 1) then
            matrix%first(row + 1) = matrix%first(row + 1) + 1
          else
            matrix%column(next(row)) = max(i, j)
            source(next(row)) = p
            next(row) = next(row) + 1
          end if
        end do
      end do
      if (pass == 2) exit
      matrix%first(1) = 1
      do i = 1, size(members)
        matrix%first(i + 1) = matrix%first(i) + matrix%first(i + 1)
      end do
      next = matrix%first(:size(members))
      allocate (matrix%column(matrix%first(size(members) + 1) - 1), source(matrix%first(size(members) + 1) - 1))
    end do
    do i = 1, size(members)
      call sort_row(matrix%column(matrix%first(i):matrix%first(i + 1) - 1), source(matrix%first(i):matrix%first(i + 1) - 1))
    end do
  end subroutine take_submatrix


  !> Sorts the columns of a row, which nearly ascend, by insertion.
  pure subroutine sort_row(column, source)
    integer, intent(inout) :: column(:), source(:)
    integer :: i, k, moved(2)
    do i = 2, size(column)
      moved = [column(i), source(i)]
      do k = i - 1, 1, -1
        if (column(k) < moved(1)) exit
        column(k + 1) = column(k)
        source(k + 1) = source(k)
      end do
      column(k + 1) = moved(1)
      source(k + 1) = moved(2)
    end do
  end subroutine sort_row


  !> New values of A, and their preconditioner.
  subroutine update_distributed_two_level(self, matrix, is_broken, error)
    type(distributed_two_level_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix        !< A or the part of this rank, of the pattern divided
    logical, intent(out) :: is_broken              !< .true.: A is far from positive definite, no preconditioner
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: shift
    is_broken = .false.
    if (.not. allocated(self%matrix%value)) allocate (self%matrix%value(size(self%matrix%column)))
    call renew_distributed_matrix(self, matrix)
    call share_matrix(self)
    call factorise_second_level(self%levels, self%matrix, self%n_entries, error)
    call share_error(error)
    if (allocated(error)) return
    select type (factor => self%levels%coarse_factor)
    type is (divided_coarse_factor_type)
      self%n_coarse = factor%n_summed
    end select
    call renew_distributed_matrix(self, matrix)
    call factorise_first_level(self%levels, self%matrix, is_broken)
    shift = -min_over_ranks(-self%levels%incomplete%shift)
    if (self%levels%incomplete%shift < shift) call factorise_first_level(self%levels, self%matrix, is_broken, shift)
    is_broken = min_over_ranks(merge(0.0_DP, 1.0_DP, is_broken)) < 0.5_DP
  end subroutine update_distributed_two_level


  !> New values of A on the domain; the preconditioner stays that of earlier ones.
  subroutine renew_distributed_matrix(self, matrix)
    type(distributed_two_level_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix        !< A or the part of this rank, of the pattern divided
    if (allocated(self%source)) then
      self%matrix%value = matrix%value(self%source)
    else
      call sum_domain(self%parts, matrix, self%matrix)
    end if
  end subroutine renew_distributed_matrix


  !> This rank's share of A: entries of its own rows count half where both ranks have them, so that the shares sum to A.
  pure subroutine share_matrix(self)
    type(distributed_two_level_type), intent(inout) :: self
    integer :: i, p
    do i = 1, self%matrix%n_rows
      do p = self%matrix%first(i), self%matrix%first(i + 1) - 1
        if (i > self%halo%n_own) then
          self%matrix%value(p) = 0
        else if (self%matrix%column(p) > self%halo%n_own) then
          self%matrix%value(p) = 0.5_DP * self%matrix%value(p)
        end if
      end do
    end do
  end subroutine share_matrix


  !> z ~ inv(A) r of whole vectors, by one application of the preconditioner.
  subroutine apply_distributed_two_level(self, r, z)
    type(distributed_two_level_type), intent(inout), target :: self
    real(DP), intent(in) :: r(:)                   !< (n) the same on all ranks
    real(DP), intent(out) :: z(:)                  !< (n)
    type(divided_preconditioner_type) :: preconditioner
    real(DP) :: own(self%halo%n_own)
    preconditioner%solver => self
    call preconditioner%apply(r(own_unknowns(self)), own)
    call collect(self, own, z)
  end subroutine apply_distributed_two_level


  !> Solves A x = b for whole vectors by conjugate gradients, from x = 0.
  subroutine solve_distributed_two_level(self, is_current, b, x, options, report)
    type(distributed_two_level_type), intent(inout), target :: self
    logical, intent(in) :: is_current              !< the preconditioner is of this A: its levels may follow one another
    real(DP), intent(in) :: b(:)                   !< (n) the same on all ranks
    real(DP), intent(out) :: x(:)                  !< (n)
    type(krylov_options_type), intent(in) :: options
    type(krylov_report_type), intent(out) :: report
    type(divided_matrix_type) :: matrix
    type(divided_preconditioner_type) :: preconditioner
    real(DP) :: own(self%halo%n_own)
    matrix%solver => self
    preconditioner%solver => self
    preconditioner%is_deflated = is_current
    own = 0
    call conjugate_gradients(matrix, preconditioner, b(own_unknowns(self)), own, options, report)
    call collect(self, own, x)
  end subroutine solve_distributed_two_level


  !> Solves (A - D) x = b for whole vectors by GMRES, from x = 0. Errors: out of memory; D beyond the pattern of A.
  subroutine solve_distributed_unsymmetric(self, is_current, skew, b, x, options, report, error)
    type(distributed_two_level_type), intent(inout), target :: self
    logical, intent(in) :: is_current              !< the preconditioner is of this A
    type(sparse_type), intent(in) :: skew          !< D: the rows of own_unknowns, columns of all unknowns
    real(DP), intent(in) :: b(:)                   !< (n) the same on all ranks
    real(DP), intent(out) :: x(:)                  !< (n)
    type(krylov_options_type), intent(in) :: options
    type(krylov_report_type), intent(out) :: report
    type(error_type), allocatable, intent(out) :: error
    type(divided_matrix_type) :: matrix
    type(divided_preconditioner_type) :: preconditioner
    real(DP) :: own(self%halo%n_own)
    integer :: place(size(b)), i
    place = 0
    place(self%halo%unknown) = [(i, i=1, size(self%halo%unknown))]
    matrix%skew = skew
    matrix%skew%column = place(skew%column)
    if (any(matrix%skew%column == 0)) call set_error(error, EXIT_INTERNAL, &
      'A part of the tangent joins unknowns that the stiffness does not join.')
    call share_error(error)
    if (allocated(error)) return
    matrix%solver => self
    preconditioner%solver => self
    preconditioner%is_deflated = is_current
    own = 0
    call gmres(matrix, preconditioner, b(own_unknowns(self)), own, options, report, error)
    call share_error(error)
    if (.not. allocated(error)) call collect(self, own, x)
  end subroutine solve_distributed_unsymmetric


  !> The unknowns of this rank, ascending.
  pure function own_unknowns(self) result(unknowns)
    type(distributed_two_level_type), intent(in) :: self
    integer :: unknowns(self%halo%n_own)
    unknowns = self%halo%unknown(:self%halo%n_own)
  end function own_unknowns


  !> Takes the largest counts of all ranks, for describe_messages.
  subroutine compare_messages(self)
    type(distributed_two_level_type), intent(inout) :: self
    integer :: k
    associate (halo => self%halo)
      self%most = real([int(halo%n_own, I64), int(size(halo%unknown) - halo%n_own, I64), size(halo%neighbour, kind=I64), &
        halo%n_messages, halo%n_bytes], DP)
    end associate
    do k = 1, size(self%most)
      self%most(k) = -min_over_ranks(-self%most(k))
    end do
  end subroutine compare_messages


  !> What a rank has and sends at most, by the counters of all ranks; empty without an iteration.
  pure function describe_messages(self) result(text)
    type(distributed_two_level_type), intent(in) :: self
    character(:), allocatable :: text
    character(240) :: line
    real(DP) :: per_iteration
    text = ''
    if (self%n_iterations == 0) return
    per_iteration = 1.0_DP / real(self%n_iterations, DP)
    write (line, '(3(a, i0), a, f0.1, a, f0.1, a, i0, a)') 'A rank has at most ', nint(self%most(1)), ' unknowns, ', &
      nint(self%most(2)), ' in its halo and ', nint(self%most(3)), ' neighbours; it sends ', per_iteration * self%most(4), &
      ' messages and ', 1.0e-3_DP * per_iteration * self%most(5), ' kilobytes in a Krylov iteration. ', self%n_coarse, &
      ' coarse unknowns are summed over the ranks.'
    text = trim(line)
  end function describe_messages


  !> Frees A on the domain and its preconditioner. The counts of describe_messages stay.
  subroutine discard_domain(self)
    type(distributed_two_level_type), intent(inout) :: self
    self%matrix = sparse_type()
    self%parts = domain_sum_type()
    call discard_preconditioner(self%levels)
  end subroutine discard_domain


  !> The whole vector of which each rank has its own unknowns.
  subroutine collect(self, own, x)
    type(distributed_two_level_type), intent(in) :: self
    real(DP), intent(in) :: own(:)
    real(DP), intent(out) :: x(:)
    real(DP), allocatable :: by_rank(:)
    call join_parts(own, by_rank)
    x = by_rank(self%place)
  end subroutine collect


  !> y = (A - D) x on own unknowns: the rows of the halo are not complete and are not used.
  subroutine apply_matrix(self, x, y)
    class(divided_matrix_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_own)
    real(DP), intent(out) :: y(:)                  !< (n_own)
    real(DP), dimension(size(self%solver%halo%unknown)) :: on_domain, product
    on_domain(:size(x)) = x
    call fill_halo(self%solver%halo, on_domain)
    call multiply_symmetric(self%solver%matrix, on_domain, product)
    y = product(:size(y))
    if (.not. allocated(self%skew%first)) return
    call multiply(self%skew, on_domain, product(:size(y)))
    y = y - product(:size(y))
  end subroutine apply_matrix


  !> The sum over all unknowns from that over own unknowns.
  subroutine complete_over_ranks(self, sum)
    class(divided_matrix_type), intent(inout) :: self
    real(DP), intent(inout) :: sum
    real(DP) :: parts(1)
    associate (unused => self)
    end associate
    parts = sum
    call sum_over_ranks(parts)
    sum = parts(1)
  end subroutine complete_over_ranks


  !> z: the preconditioner times r, on own unknowns: the sum of the levels, or one after the other.
  subroutine apply_levels(self, x, y)
    class(divided_preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< r (n_own)
    real(DP), intent(out) :: y(:)                  !< z (n_own)
    real(DP), dimension(size(self%solver%halo%unknown)) :: r, z
    real(DP) :: correction(size(x))
    associate (solver => self%solver, n => size(x))
      solver%n_iterations = solver%n_iterations + 1
      r(:n) = x
      call fill_halo(solver%halo, r)
      r = solver%weight * r
      call apply_first_level(solver%levels, solver%matrix, r, z)
      z = solver%weight * z
      call return_halo(solver%halo, z)
      y = z(:n)
      if (self%is_deflated .and. solver%levels%has_coarse_space) then
        call fill_halo(solver%halo, z)
        call multiply_symmetric(solver%matrix, z, r)
        call correct_by_second_level(self, x - r(:n), correction)
      else
        call correct_by_second_level(self, x, correction)
      end if
      y = y + correction
    end associate
  end subroutine apply_levels


  !> z = Z inv(Z'AZ) Z' r on own unknowns; 0 without a second level.
  subroutine correct_by_second_level(self, r, z)
    class(divided_preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: r(:)                   !< (n_own)
    real(DP), intent(out) :: z(:)                  !< (n_own)
    real(DP), dimension(size(self%solver%halo%unknown)) :: on_domain, correction
    real(DP), allocatable :: c(:)
    z = 0
    associate (solver => self%solver)
      if (.not. solver%levels%has_coarse_space) return
      on_domain(:size(r)) = r
      on_domain(size(r) + 1:) = 0
      call restrict_residual(solver%levels, on_domain, c)
      call solve_second_level(solver%levels, c)
      correction = 0
      call add_correction(solver%levels, c, correction)
      z = correction(:size(z))
    end associate
  end subroutine correct_by_second_level


  !> The same before the first iteration, if the levels follow one another; else 0.
  subroutine correct_start(self, r, z)
    class(divided_preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: r(:)                   !< (n_own)
    real(DP), intent(out) :: z(:)                  !< (n_own)
    z = 0
    if (self%is_deflated) call correct_by_second_level(self, r, z)
  end subroutine correct_start

end module amontons_distributed_two_level
