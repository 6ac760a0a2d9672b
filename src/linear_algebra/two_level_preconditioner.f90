!> Two-level preconditioner: incomplete Cholesky plus a coarse space of rigid body motions of mesh parts.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! It replaces a Cholesky factor that would be too large. Two levels, added:
!!
!!     inv(A)  ~  inv(U'U)  +  Z inv(Z'AZ) Z'
!!
!! U is an incomplete Cholesky factor with the pattern of A: it reduces the oscillatory error. The columns of Z are the six rigid
!! body motions of each of many small parts of the mesh: they reduce the smooth error across the whole body. Z'AZ is sparse and
!! factorized by CHOLMOD. Both factors are in single precision. Both terms are symmetric and positive definite, so that conjugate
!! gradients can use the sum.
!!
!! Krylov methods on this very A apply one level after the other (`apply_deflated`): the second one acts on the residual that the
!! first one leaves, which takes a little more than half of the iterations of the sum.
!!
!! Quadratic elements: the columns of Z are those of P, the shape functions of the linear elements on the corners, if the factor of
!! P'AP is not larger than the share MAX_CORNER_ENTRIES of A. They reduce all but the error between neighbouring nodes.
!! References: those of `incomplete_cholesky`; Nicolaides, SIAM J. Numer. Anal. 24 (1987) 355 and Mandel, Comm. Numer. Meth. Engng 9
!! (1993) 233 (motions of parts); Tang, Nabben, Vuik, Erlangga, J. Scientific Computing 39 (2009) 340 (levels one after the other:
!! A-DEF2).
module amontons_two_level_preconditioner
  use amontons_kinds, only: DP, SP, I64
  use amontons_containers, only: list_groups
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose, multiply_symmetric
  use amontons_midside_interpolation, only: build_midside_interpolation, project_to_corners
  use amontons_dense, only: solve_symmetric_eigen, DENSE_OK
  use amontons_point_partition, only: partition_points
  use amontons_incomplete_cholesky, only: incomplete_cholesky_type, factorise_incomplete, apply_incomplete, discard_incomplete
  use amontons_coarse_factor, only: coarse_factor_type
!$ use omp_lib, only: omp_get_max_threads
  implicit none
  private
  public :: two_level_preconditioner_type, build_coarse_space, offer_corner_space, factorise_two_level, &
    apply_preconditioner, apply_deflated, correct_in_coarse_space, choose_n_parts, &
    elements_of_part, two_level_megabytes, discard_preconditioner
  public :: rigid_motion
  public :: take_coarse_space, factorise_first_level, factorise_second_level, apply_first_level, restrict_residual, &
    solve_second_level, add_correction

  real(DP), parameter :: NODES_PER_PART = 60.0_DP   !< fewer iterations with smaller parts, but a larger coarse factor | 0012
  real(DP), parameter :: NODES_OF_LARGE_MESH = 1.0e5_DP   !< from here on the nodes of a part grow with the fourth root | 0012
  real(DP), parameter :: COARSE_ENTRIES_RATIO = 30.0_DP   !< entries of the factor of Z'AZ over its size to the power 4/3 [-]
  real(DP), parameter :: MAX_CORNER_ENTRIES = 1.5_DP   !< entries of the factor of P'AP over those of A; at 2 a solution with it
                                                   !! reads as many bytes as one with U and its pattern [-] | 0012
  real(DP), parameter :: MAX_CORNER_SHARE = 0.5_DP !< unknowns of corners over all: more are not a coarse space [-]
  integer, parameter :: MIN_UNKNOWNS_PER_DOMAIN = 10000   !< smaller domains cost iterations and save no time | 0012
  integer, parameter :: SHARES_PER_THREAD = 8      !< of the parts, so that no thread waits for long
  real(DP), parameter :: TOL_DEPENDENT_MOTION = 1.0e-8_DP         !< a motion with a smaller independent component is dropped [-]

  !> The preconditioner of one matrix.
  type :: two_level_preconditioner_type
    type(incomplete_cholesky_type) :: incomplete       !< U
    real(DP), allocatable :: place(:, :)               !< (3, n) of each unknown, if there are several threads [length]
    integer, allocatable :: domain(:)                  !< (n) of each unknown; empty: one domain
    integer :: n_parts = 0
    integer, allocatable :: part(:)                    !< (n) of each unknown
    real(SP), allocatable :: motion(:, :)              !< (6, n) rigid body motions of its part at each unknown, orthonormal
    type(sparse_type) :: interpolation                 !< P, in place of the motions as Z; not allocated: the motions serve
    logical :: has_coarse_space = .false.              !< Z'AZ is positive definite
    integer :: n_own = -1                              !< unknowns of this rank, which come first; -1: ranks do not share A
    class(coarse_factor_type), allocatable :: coarse_factor   !< of Z'AZ, in single precision
  end type two_level_preconditioner_type

  !> Blocks of the upper triangle of Z'AZ, of 6 x 6, in the order in which they were made; those of one place are added.
  type :: block_list_type
    integer :: n = 0
    integer, allocatable :: row(:), column(:)          !< (at least n) parts, row <= column
    real(DP), allocatable :: value(:, :, :)            !< (6, 6, at least n)
  end type block_list_type

contains

  !> Number of parts for a number of nodes.
  pure integer function choose_n_parts(n_nodes) result(n_parts)
    integer, intent(in) :: n_nodes
    n_parts = max(1, int(real(n_nodes, DP) / nodes_of_part(n_nodes)))
  end function choose_n_parts


  !> Nodes of a part. The cost of the coarse factor grows with the square of the number of parts: in large meshes parts of one size
  !! would take more time than the iterations they save.
  pure real(DP) function nodes_of_part(n_nodes)
    integer, intent(in) :: n_nodes                     !< of the mesh
    nodes_of_part = NODES_PER_PART * max(1.0_DP, real(n_nodes, DP) / NODES_OF_LARGE_MESH)**0.25_DP
  end function nodes_of_part


  !> Elements of a part.
  pure integer function elements_of_part(n_elements, n_nodes)
    integer, intent(in) :: n_elements, n_nodes
    elements_of_part = max(1, nint(nodes_of_part(n_nodes) * real(n_elements, DP) / real(max(1, n_nodes), DP)))
  end function elements_of_part


  !> Memory of the preconditioner [megabytes]; at most, if the corners of quadratic elements serve.
  pure real(DP) function two_level_megabytes(n, n_entries, n_parts, is_quadratic) result(megabytes)
    integer, intent(in) :: n                           !< unknowns
    integer, intent(in) :: n_entries                   !< of the upper triangle
    integer, intent(in) :: n_parts
    logical, intent(in) :: is_quadratic                !< there are elements with mid-side nodes
    megabytes = (12.0_DP * real(n_entries, DP) + 52.0_DP * real(n, DP) + &
      8.0_DP * COARSE_ENTRIES_RATIO * (6.0_DP * real(n_parts, DP))**(4.0_DP / 3.0_DP)) / 1.0e6_DP
    if (is_quadratic) megabytes = megabytes + 8.0e-6_DP * MAX_CORNER_ENTRIES * real(n_entries, DP)
  end function two_level_megabytes


  !> Z: the rigid body motions of each part at its unknowns. The threads share the parts.
  subroutine build_coarse_space(self, part, axis, place, n_parts)
    type(two_level_preconditioner_type), intent(inout) :: self
    integer, intent(in) :: part(:)                     !< (n) of each unknown, 1 to n_parts
    integer, intent(in) :: axis(:)                     !< (n) direction of the unknown, 1 to 3
    real(DP), intent(in) :: place(:, :)                !< (3, n) coordinates of its node [length]
    integer, intent(in) :: n_parts
    integer, allocatable :: first(:), members(:)
    integer :: p
    self%n_parts = n_parts
    self%part = part
    call discard_domains(self)
!$  if (omp_get_max_threads() > 1) self%place = place
    if (allocated(self%motion)) deallocate (self%motion)
    allocate (self%motion(6, size(part)))
    call list_groups(part, n_parts, first, members)
    !$omp parallel do schedule(dynamic, 16)
    do p = 1, n_parts
      call find_motions(members(first(p):first(p + 1) - 1), axis, place, self%motion)
    end do
    !$omp end parallel do
  end subroutine build_coarse_space


  !> Offers the interpolation from the corners of quadratic elements as Z. Whether it serves depends on the factor of P'AP.
  subroutine offer_corner_space(self, ends)
    type(two_level_preconditioner_type), intent(inout) :: self
    integer, intent(in) :: ends(:, :)                  !< (2, n) unknowns at the ends of the edge; 0: not free; [i, i]: a corner
    integer :: i
    self%interpolation = sparse_type()
    if (count([(ends(1, i) == i, i=1, size(ends, 2))]) > int(MAX_CORNER_SHARE * real(size(ends, 2), DP))) return
    call build_midside_interpolation(ends, self%interpolation)
  end subroutine offer_corner_space


  !> The same Z at some of the unknowns.
  subroutine take_coarse_space(self, whole, members)
    type(two_level_preconditioner_type), intent(inout) :: self
    type(two_level_preconditioner_type), intent(in) :: whole
    integer, intent(in) :: members(:)                  !< unknowns of `whole`
    integer :: i, n
    self%n_parts = whole%n_parts
    self%part = whole%part(members)
    call discard_domains(self)
    if (allocated(whole%place)) self%place = whole%place(:, members)
    self%motion = whole%motion(:, members)
    self%interpolation = sparse_type()
    if (.not. allocated(whole%interpolation%first)) return
    associate (from => whole%interpolation, P => self%interpolation)
      P%n_rows = size(members)
      P%n_columns = from%n_columns
      allocate (P%first(P%n_rows + 1))
      P%first(1) = 1
      do i = 1, P%n_rows
        P%first(i + 1) = P%first(i) + from%first(members(i) + 1) - from%first(members(i))
      end do
      allocate (P%column(P%first(P%n_rows + 1) - 1), P%value(P%first(P%n_rows + 1) - 1))
      do i = 1, P%n_rows
        n = from%first(members(i)) - P%first(i)
        P%column(P%first(i):P%first(i + 1) - 1) = from%column(P%first(i) + n:P%first(i + 1) - 1 + n)
        P%value(P%first(i):P%first(i + 1) - 1) = from%value(P%first(i) + n:P%first(i + 1) - 1 + n)
      end do
    end associate
  end subroutine take_coarse_space


  !> Three translations and three rotations about the centre, at one unknown.
  pure function rigid_motion(axis, x) result(motion)
    integer, intent(in) :: axis                        !< 1 to 3
    real(DP), intent(in) :: x(3)                       !< from the centre, scaled to the part [-]
    real(DP) :: motion(6)
    motion = 0
    motion(axis) = 1
    select case (axis)
    case (1)
      motion(5:6) = [x(3), -x(2)]
    case (2)
      motion(4) = -x(3)
      motion(6) = x(1)
    case (3)
      motion(4:5) = [x(2), -x(1)]
    end select
  end function rigid_motion


  !> The six motions of a part, orthonormalized: zeros in place of those that depend on the others.
  subroutine find_motions(members, axis, place, motion)
    integer, intent(in) :: members(:)                  !< unknowns of the part
    integer, intent(in) :: axis(:)                     !< (n) direction of each unknown
    real(DP), intent(in) :: place(:, :)                !< (3, n) [length]
    real(SP), intent(inout) :: motion(:, :)            !< (6, n) those of the members are set
    real(DP) :: centre(3), extent, gram(6, 6), turn(6, 6), values(6), vectors(6, 6)
    integer :: k, m, status
    centre = 0
    do k = 1, size(members)
      centre = centre + place(:, members(k))
    end do
    centre = centre / real(max(size(members), 1), DP)
    extent = tiny(1.0_DP)
    do k = 1, size(members)
      extent = max(extent, maxval(abs(place(:, members(k)) - centre)))
    end do
    gram = 0
    do k = 1, size(members)
      associate (i => members(k))
        motion(:, i) = real(rigid_motion(axis(i), (place(:, i) - centre) / extent), SP)
        do m = 1, 6
          gram(:, m) = gram(:, m) + real(motion(:, i), DP) * real(motion(m, i), DP)
        end do
      end associate
    end do
    call solve_symmetric_eigen(gram, values, vectors, status)
    turn = 0
    do m = 1, 6
      if (status == DENSE_OK .and. values(m) > TOL_DEPENDENT_MOTION * values(6)) turn(m, :) = vectors(:, m) / sqrt(values(m))
    end do
    do k = 1, size(members)
      motion(:, members(k)) = real(matmul(turn, real(motion(:, members(k)), DP)), SP)
    end do
  end subroutine find_motions


  !> Builds the preconditioner of a matrix: U and the factor of Z'AZ.
  subroutine factorise_two_level(self, matrix, is_broken, error)
    type(two_level_preconditioner_type), intent(inout) :: self        !< after build_coarse_space, or without parts
    type(sparse_type), intent(in) :: matrix            !< A: symmetric, upper triangle with its diagonal
    logical, intent(out) :: is_broken                  !< .true.: A is far from positive definite, no preconditioner
    type(error_type), allocatable, intent(out) :: error
    is_broken = .false.
    call factorise_second_level(self, matrix, size(matrix%column, kind=I64), error)   ! first: its workspace is larger than U
    if (.not. allocated(error)) call factorise_first_level(self, matrix, is_broken)
  end subroutine factorise_two_level


  !> U, the first level.
  subroutine factorise_first_level(self, matrix, is_broken, least_shift)
    type(two_level_preconditioner_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix            !< A
    logical, intent(out) :: is_broken                  !< .true.: A is far from positive definite
    real(DP), intent(in), optional :: least_shift      !< of the diagonal, to begin with in place of 0 [-]
    if (.not. allocated(self%domain)) call choose_domains(self)
    call factorise_incomplete(self%incomplete, matrix, self%domain, is_broken, least_shift)
  end subroutine factorise_first_level


  !> Divides the unknowns by their places into halves, and these again, a domain for each thread.
  subroutine choose_domains(self)
    type(two_level_preconditioner_type), intent(inout) :: self
    integer :: n, n_domains, n_made
    allocate (self%domain(0))
    if (.not. allocated(self%place)) return
    n = size(self%place, 2)
    n_domains = 1
!$  n_domains = 2**exponent(real(min(omp_get_max_threads(), n / MIN_UNKNOWNS_PER_DOMAIN))) / 2
    if (n_domains < 2) return
    deallocate (self%domain)
    allocate (self%domain(n))
    call partition_points(self%place, (n + n_domains - 1) / n_domains, self%domain, n_made)
  end subroutine choose_domains


  !> Frees the memory of the preconditioner.
  subroutine discard_preconditioner(self)
    type(two_level_preconditioner_type), intent(inout) :: self
    call discard_incomplete(self%incomplete)
    self%n_parts = 0
    self%has_coarse_space = .false.
    if (allocated(self%coarse_factor)) deallocate (self%coarse_factor)
    if (allocated(self%part)) deallocate (self%part, self%motion)
    call discard_domains(self)
    self%interpolation = sparse_type()
  end subroutine discard_preconditioner


  !> Frees the places and domains of the unknowns.
  subroutine discard_domains(self)
    type(two_level_preconditioner_type), intent(inout) :: self
    if (allocated(self%place)) deallocate (self%place)
    if (allocated(self%domain)) deallocate (self%domain)
  end subroutine discard_domains


  !> The factor of Z'AZ: of the corners of quadratic elements if it is small enough, else of the motions of the parts. Without a
  !! positive definite Z'AZ there is no second level.
  subroutine factorise_second_level(self, matrix, n_entries, error)
    type(two_level_preconditioner_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix            !< A, or what this rank has of it
    integer(I64), intent(in) :: n_entries            !< of A
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: coarse
    self%has_coarse_space = .false.
    if (.not. allocated(self%coarse_factor)) allocate (self%coarse_factor)
    if (allocated(self%interpolation%first)) then
      call project_to_corners(self%interpolation, matrix, coarse, error)
      if (allocated(error)) return
      call self%coarse_factor%factorise(coarse, held_columns(self, coarse%n_rows), MAX_CORNER_ENTRIES * real(n_entries, DP), &
        self%has_coarse_space, error)
      if (allocated(error) .or. self%has_coarse_space) return
      self%interpolation = sparse_type()
    end if
    if (self%n_parts == 0) return
    call assemble_coarse_matrix(self, matrix, coarse)
    call self%coarse_factor%factorise(coarse, held_columns(self, coarse%n_rows), huge(1.0_DP), self%has_coarse_space, error)
  end subroutine factorise_second_level


  !> Which columns of Z have entries in rows of this rank.
  pure function held_columns(self, n_columns) result(is_held)
    type(two_level_preconditioner_type), intent(in) :: self
    integer, intent(in) :: n_columns
    logical :: is_held(n_columns)
    integer :: i
    is_held = self%n_own < 0
    associate (P => self%interpolation)
      do i = 1, self%n_own
        if (allocated(P%first)) then
          is_held(P%column(P%first(i):P%first(i + 1) - 1)) = .true.
        else
          is_held(6 * self%part(i) - 5:6 * self%part(i)) = .true.
        end if
      end do
    end associate
  end function held_columns


  !> Z'AZ, upper triangle. W = Z'BZ, where B is the upper triangle of A with half of its diagonal, gives Z'AZ = W + W'. W is
  !! assembled by rows of blocks of 6 x 6, a block for each pair of parts that A couples. The threads share the rows of blocks; the
  !! blocks are in the order of the rows with any number of threads.
  subroutine assemble_coarse_matrix(self, matrix, coarse)
    type(two_level_preconditioner_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix
    type(sparse_type), intent(out) :: coarse
    type(block_list_type), allocatable :: share(:)
    integer, allocatable :: first(:), members(:)
    integer :: n_shares, n_threads, t
    call list_groups(self%part, self%n_parts, first, members)
    n_threads = 1
!$  if (allocated(self%place)) n_threads = omp_get_max_threads()
    n_shares = SHARES_PER_THREAD * n_threads
    allocate (share(n_shares))
    !$omp parallel do schedule(dynamic, 1) num_threads(n_threads)
    do t = 1, n_shares
      call assemble_block_rows(self, matrix, first, members, share_end(self%n_parts, n_shares, t - 1) + 1, &
        share_end(self%n_parts, n_shares, t), share(t))
    end do
    !$omp end parallel do
    call join_blocks(self%n_parts, share, coarse)
  end subroutine assemble_coarse_matrix


  !> The last of n items in the first k of equal shares.
  pure integer function share_end(n, n_shares, k)
    integer, intent(in) :: n, n_shares, k
    share_end = int(int(k, I64) * int(n, I64) / int(n_shares, I64))
  end function share_end


  !> The upper triangle of a matrix from its blocks.
  subroutine join_blocks(n_parts, share, matrix)
    integer, intent(in) :: n_parts
    type(block_list_type), intent(in) :: share(:)
    type(sparse_type), intent(out) :: matrix
    integer, allocatable :: row(:), column(:), list(:), place(:), by_column(:), by_row(:), first(:)
    integer :: t, k, a, n, p, l
    row = [(share(t)%row(:share(t)%n), t=1, size(share))]
    column = [(share(t)%column(:share(t)%n), t=1, size(share))]
    list = [([(t, k=1, share(t)%n)], t=1, size(share))]
    place = [([(k, k=1, share(t)%n)], t=1, size(share))]
    ! Two stable sorts, by column and then by row, place the blocks of one place next to each other in their order.
    call list_groups(column, n_parts, first, by_column)
    call list_groups(row(by_column), n_parts, first, by_row)
    by_row = by_column(by_row)
    n = 0
    do k = 1, size(row)
      if (.not. is_repeated(k)) n = n + merge(21, 36, row(by_row(k)) == column(by_row(k)))
    end do
    matrix%n_rows = 6 * n_parts
    matrix%n_columns = 6 * n_parts
    allocate (matrix%first(6 * n_parts + 1), matrix%column(n), matrix%value(n))
    p = 1
    do a = 1, n_parts
      do l = 1, 6
        matrix%first(6 * (a - 1) + l) = p
        do k = first(a), first(a + 1) - 1
          call add_row_of_block(by_row(k), merge(l, 1, column(by_row(k)) == a), is_repeated(k))
        end do
      end do
    end do
    matrix%first(6 * n_parts + 1) = p

  contains

    !> Row l of a block, from column n of the block on: added to the entries before, or behind them.
    subroutine add_row_of_block(b, n, is_added)
      integer, intent(in) :: b, n
      logical, intent(in) :: is_added
      integer :: i
      if (.not. is_added) then
        matrix%column(p:p + 6 - n) = 6 * (column(b) - 1) + [(i, i=n, 6)]
        matrix%value(p:p + 6 - n) = 0
        p = p + 7 - n
      end if
      matrix%value(p - 7 + n:p - 1) = matrix%value(p - 7 + n:p - 1) + share(list(b))%value(l, n:6, place(b))
    end subroutine add_row_of_block

    !> Whether a block is at the place of the one before.
    pure logical function is_repeated(k)
      integer, intent(in) :: k                         !< place in by_row
      is_repeated = .false.
      if (k > 1) is_repeated = row(by_row(k)) == row(by_row(k - 1)) .and. column(by_row(k)) == column(by_row(k - 1))
    end function is_repeated

  end subroutine join_blocks


  !> The rows of blocks of some parts.
  subroutine assemble_block_rows(self, matrix, first, members, low, high, blocks)
    type(two_level_preconditioner_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: first(:), members(:)        !< unknowns of each part
    integer, intent(in) :: low, high                   !< parts
    type(block_list_type), intent(out) :: blocks
    integer, allocatable :: block_of(:), touched(:)
    real(DP), allocatable :: block_row(:, :, :)
    integer :: a, k, n_touched
    allocate (blocks%row(0), blocks%column(0), blocks%value(6, 6, 0), block_row(6, 6, 64), touched(self%n_parts))
    allocate (block_of(self%n_parts), source=0)
    do a = low, high
      n_touched = 0
      do k = first(a), first(a + 1) - 1
        call add_row_to_blocks(self, matrix, members(k), block_of, touched, n_touched, block_row)
      end do
      do k = 1, n_touched
        call append_block(a, touched(k), block_row(:, :, k), blocks)
      end do
      block_of(touched(:n_touched)) = 0
    end do
  end subroutine assemble_block_rows


  !> Adds the contribution of row i of B to the blocks of its part: its motions times (B Z)_i.
  subroutine add_row_to_blocks(self, matrix, i, block_of, touched, n_touched, block_row)
    type(two_level_preconditioner_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: i
    integer, intent(inout) :: block_of(:)              !< (n_parts) index of the block of a part; 0: none yet
    integer, intent(inout) :: touched(:)               !< (n_parts) part of each block
    integer, intent(inout) :: n_touched                !< blocks
    real(DP), allocatable, intent(inout) :: block_row(:, :, :)   !< (6, 6, at least n_touched)
    real(DP) :: product(6)
    integer :: p, k, b, m
    p = matrix%first(i)
    product = 0.5_DP * matrix%value(p) * real(self%motion(:, i), DP)
    b = self%part(i)
    do k = p + 1, matrix%first(i + 1)
      if (k == matrix%first(i + 1)) then
        call add_product()
      else if (self%part(matrix%column(k)) /= b) then
        call add_product()
        b = self%part(matrix%column(k))
        product = matrix%value(k) * real(self%motion(:, matrix%column(k)), DP)
      else
        product = product + matrix%value(k) * real(self%motion(:, matrix%column(k)), DP)
      end if
    end do

  contains

    !> Adds the product of the row with part b to its block.
    subroutine add_product()
      if (block_of(b) == 0) then
        n_touched = n_touched + 1
        block_of(b) = n_touched
        touched(n_touched) = b
        if (n_touched > size(block_row, 3)) block_row = reshape(block_row, [6, 6, 2 * size(block_row, 3)], pad=[0.0_DP])
        block_row(:, :, n_touched) = 0
      end if
      do m = 1, 6
        block_row(:, m, block_of(b)) = block_row(:, m, block_of(b)) + real(self%motion(:, i), DP) * product(m)
      end do
    end subroutine add_product

  end subroutine add_row_to_blocks


  !> Appends block (a, b) of W as one of the upper triangle of W + W'.
  pure subroutine append_block(a, b, block, blocks)
    integer, intent(in) :: a, b                        !< parts
    real(DP), intent(in) :: block(6, 6)
    type(block_list_type), intent(inout) :: blocks
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:, :, :)
    associate (n => blocks%n)
      if (n == size(blocks%row)) then
        allocate (row(2 * n + 64), column(2 * n + 64), value(6, 6, 2 * n + 64))
        row(:n) = blocks%row
        column(:n) = blocks%column
        value(:, :, :n) = blocks%value
        call move_alloc(row, blocks%row)
        call move_alloc(column, blocks%column)
        call move_alloc(value, blocks%value)
      end if
      n = n + 1
      blocks%row(n) = min(a, b)
      blocks%column(n) = max(a, b)
      if (a == b) then
        blocks%value(:, :, n) = block + transpose(block)
      else if (a < b) then
        blocks%value(:, :, n) = block
      else
        blocks%value(:, :, n) = transpose(block)
      end if
    end associate
  end subroutine append_block


  !> z: the preconditioner times r, as the sum of the levels.
  subroutine apply_preconditioner(self, matrix, r, z)
    type(two_level_preconditioner_type), intent(in) :: self           !< prepared
    type(sparse_type), intent(in) :: matrix            !< the matrix it was built for: its pattern
    real(DP), intent(in) :: r(:)                       !< (n)
    real(DP), intent(out) :: z(:)                      !< (n)
    call apply_first_level(self, matrix, r, z)
    call add_second_level(self, r, z)
  end subroutine apply_preconditioner


  !> z = y + Q (r - A y) with y = inv(U'U) r and Q = Z inv(Z'AZ) Z'. The levels must be those of this A. Symmetric for
  !! residuals without a component in the coarse space, as conjugate gradients have after correct_in_coarse_space.
  subroutine apply_deflated(self, matrix, r, z)
    type(two_level_preconditioner_type), intent(in) :: self           !< prepared
    type(sparse_type), intent(in) :: matrix            !< A
    real(DP), intent(in) :: r(:)                       !< (n)
    real(DP), intent(out) :: z(:)                      !< (n)
    real(DP), allocatable :: product(:)
    integer :: i
    call apply_first_level(self, matrix, r, z)
    if (.not. self%has_coarse_space) return
    allocate (product(size(r)))
    call multiply_symmetric(matrix, z, product)
    !$omp parallel do schedule(static) num_threads(self%incomplete%n_domains)
    do i = 1, size(r)
      product(i) = r(i) - product(i)
    end do
    !$omp end parallel do
    call add_second_level(self, product, z)
  end subroutine apply_deflated


  !> z = Q r; 0 without a coarse space.
  subroutine correct_in_coarse_space(self, r, z)
    type(two_level_preconditioner_type), intent(in) :: self           !< prepared
    real(DP), intent(in) :: r(:)                       !< (n)
    real(DP), intent(out) :: z(:)                      !< (n)
    z = 0
    call add_second_level(self, r, z)
  end subroutine correct_in_coarse_space


  !> Adds Q r to z.
  subroutine add_second_level(self, r, z)
    type(two_level_preconditioner_type), intent(in) :: self           !< prepared
    real(DP), intent(in) :: r(:)                       !< (n)
    real(DP), intent(inout) :: z(:)                    !< (n)
    real(DP), allocatable :: c(:)
    if (.not. self%has_coarse_space) return
    call restrict_residual(self, r, c)
    call solve_second_level(self, c)
    call add_correction(self, c, z)
  end subroutine add_second_level


  !> c = Z' r.
  subroutine restrict_residual(self, r, c)
    type(two_level_preconditioner_type), intent(in) :: self
    real(DP), intent(in) :: r(:)                       !< (n)
    real(DP), allocatable, intent(out) :: c(:)         !< a number for each column of Z
    real(DP), allocatable :: share(:, :)               ! of each thread
    integer :: t
    if (allocated(self%interpolation%first)) then
      allocate (c(self%interpolation%n_columns))
      call multiply_transpose(self%interpolation, r, c)
      return
    end if
    allocate (c(6 * self%n_parts), source=0.0_DP)
    if (self%incomplete%n_domains == 1) then
      call add_range(1, size(self%part), c)
      return
    end if
    allocate (share(6 * self%n_parts, self%incomplete%n_domains))
    !$omp parallel do schedule(static, 1) num_threads(self%incomplete%n_domains)
    do t = 1, self%incomplete%n_domains
      share(:, t) = 0
      call add_range(share_end(size(self%part), self%incomplete%n_domains, t - 1) + 1, &
        share_end(size(self%part), self%incomplete%n_domains, t), share(:, t))
    end do
    !$omp end parallel do
    do t = 1, self%incomplete%n_domains
      c = c + share(:, t)
    end do

  contains

    !> The sum over some unknowns.
    pure subroutine add_range(low, high, c)
      integer, intent(in) :: low, high
      real(DP), intent(inout) :: c(:)
      integer :: i
      do i = low, high
        associate (a => 6 * (self%part(i) - 1))
          c(a + 1:a + 6) = c(a + 1:a + 6) + real(self%motion(:, i), DP) * r(i)
        end associate
      end do
    end subroutine add_range

  end subroutine restrict_residual


  !> c becomes inv(Z'AZ) c. If ranks share A, c is Z'r of own unknowns.
  subroutine solve_second_level(self, c)
    type(two_level_preconditioner_type), intent(in) :: self
    real(DP), allocatable, intent(inout) :: c(:)
    call self%coarse_factor%solve(c)
  end subroutine solve_second_level


  !> Adds Z c to z.
  subroutine add_correction(self, c, z)
    type(two_level_preconditioner_type), intent(in) :: self
    real(DP), intent(in) :: c(:)
    real(DP), intent(inout) :: z(:)                    !< (n)
    real(DP), allocatable :: correction(:)
    integer :: i
    if (allocated(self%interpolation%first)) then
      allocate (correction(size(z)))
      call multiply(self%interpolation, c, correction)
      z = z + correction
      return
    end if
    !$omp parallel do schedule(static) num_threads(self%incomplete%n_domains)
    do i = 1, size(self%part)
      associate (a => 6 * (self%part(i) - 1))
        z(i) = z(i) + dot_product(real(self%motion(:, i), DP), c(a + 1:a + 6))
      end associate
    end do
    !$omp end parallel do
  end subroutine add_correction


  !> z = inv(U) inv(U') r.
  subroutine apply_first_level(self, matrix, r, z)
    type(two_level_preconditioner_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix            !< A: its pattern is that of U, if there is one domain
    real(DP), intent(in) :: r(:)
    real(DP), intent(out) :: z(:)
    call apply_incomplete(self%incomplete, matrix, r, z)
  end subroutine apply_first_level

end module amontons_two_level_preconditioner
